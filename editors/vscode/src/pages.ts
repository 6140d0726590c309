// Explanations and the page of `fretc play`, beside the editor.

import { randomBytes } from "node:crypto";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import * as vscode from "vscode";
import { type Explanation, explanationPage, hasStrictPolicy } from "./explanation";
import { type Result, run } from "./program";
import { type Project, explainArguments, playArguments } from "./project";
import { programPath } from "./settings";

/** fretc has not printed a page; the message says why. */
export class NoPageError extends Error {}

/** Show the meaning of a requirement. Stopping is a CanceledError. */
export async function explain(project: Project, id: string, signal: AbortSignal): Promise<void> {
  const folder = await mkdtemp(join(tmpdir(), "fretc-"));
  try {
    const diagram = join(folder, "diagram.svg");
    const result = await run(programPath(), explainArguments(project, id, diagram), project.folder, signal);
    const [explanation] = (printed(result) ? JSON.parse(result.stdout) : []) as Explanation[];
    if (!explanation) throw new NoPageError(result.stderr.trim());
    const svg = await readFile(diagram, "utf8").catch(() => "");
    show("explain", `Explain ${id}`, explanationPage(explanation, svg, randomBytes(16).toString("base64")), false);
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

/** Show the page on which the user edits runs of the project. */
export async function play(project: Project, signal: AbortSignal): Promise<void> {
  const result = await run(programPath(), playArguments(project), project.folder, signal);
  if (!printed(result)) throw new NoPageError(result.stderr.trim());
  if (!hasStrictPolicy(result.stdout)) throw new NoPageError("the page has no content security policy");
  show("play", `Play ${project.requirements}`, result.stdout, true);
}

function printed({ stdout }: Result): boolean {
  return stdout.trim() !== "";
}

const panels = new Map<string, vscode.WebviewPanel>();

function show(kind: string, title: string, html: string, hasScripts: boolean): void {
  let panel = panels.get(title);
  if (!panel) {
    const column = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    panel = vscode.window.createWebviewPanel(`fretc.${kind}`, title, column, {
      enableScripts: hasScripts,
      enableCommandUris: false,
      enableForms: false,
      localResourceRoots: [],
      retainContextWhenHidden: hasScripts, // what the user has edited would be lost
    });
    panels.set(title, panel);
    panel.onDidDispose(() => panels.delete(title));
  }
  panel.webview.html = html;
  panel.reveal(undefined, true);
}
