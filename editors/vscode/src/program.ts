// Runs fretc, without a shell, and returns what it prints.

import { spawn } from "node:child_process";

export interface Result {
  /** Exit status; null if the process was ended by a signal. */
  readonly status: number | null;
  readonly stdout: string;
  readonly stderr: string;
}

/** The program could not be started. */
export class NotStartedError extends Error {}

/** The user has stopped the program. */
export class CanceledError extends Error {}

const MOST_CHARACTERS = 256 * 1024 * 1024;

/**
 * Run a program to its end.
 * @param path a name on PATH, or an absolute path.
 * @throws NotStartedError, CanceledError
 */
export function run(path: string, args: readonly string[], cwd: string, signal?: AbortSignal): Promise<Result> {
  return new Promise((resolve, reject) => {
    const env = { ...process.env, NO_COLOR: "1", PYTHONUTF8: "1" };
    const child = spawn(path, [...args], { cwd, env, stdio: ["ignore", "pipe", "pipe"], shell: false });
    const stop = () => child.kill();
    if (signal?.aborted) stop();
    signal?.addEventListener("abort", stop, { once: true });
    const texts = { stdout: [] as string[], stderr: [] as string[] };
    let characters = 0;
    for (const name of ["stdout", "stderr"] as const) {
      child[name].setEncoding("utf8").on("data", (text: string) => {
        characters += text.length;
        if (characters > MOST_CHARACTERS) stop();
        else texts[name].push(text);
      });
    }
    child.on("error", (error) => {
      signal?.removeEventListener("abort", stop);
      reject(new NotStartedError(`${path} could not be started: ${error.message}`));
    });
    child.on("close", (status) => {
      signal?.removeEventListener("abort", stop);
      if (signal?.aborted) reject(new CanceledError("stopped"));
      else resolve({ status, stdout: texts.stdout.join(""), stderr: texts.stderr.join("") });
    });
  });
}
