// FRETish in VS Code. Nothing of fretc runs before the user trusts the workspace.

import * as vscode from "vscode";
import { type Requirement, Server, complain } from "./client";
import { NoPageError, explain, play } from "./pages";
import { CanceledError } from "./program";
import { projectOf, testArguments, verifyArguments } from "./project";
import { chooseLog, programPath } from "./settings";
import { RequirementTests } from "./tests";

/** What a command is about: the arguments of a code lens, or the place of the cursor. */
interface Target {
  readonly id: string;
  readonly uri: vscode.Uri;
}

let server: Server | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  if (vscode.workspace.isTrusted) {
    await start(context);
    return;
  }
  context.subscriptions.push(vscode.workspace.onDidGrantWorkspaceTrust(() => start(context)));
}

export async function deactivate(): Promise<void> {
  await server?.stop();
}

async function start(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel("FRETish");
  const client = (server = new Server(output));
  const tests = new RequirementTests(client, output);
  const restart = async () => {
    await client.start(programPath());
    await tests.refresh();
  };
  context.subscriptions.push(
    output,
    client,
    tests,
    vscode.commands.registerCommand("fretc.restart", restart),
    vscode.commands.registerCommand("fretc.chooseLog", () => chooseLog()),
    vscode.workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("fretc.path")) void restart();
    }),
  );
  const command = (name: string, act: (target: Target, signal: AbortSignal) => Promise<void>) => {
    context.subscriptions.push(
      vscode.commands.registerCommand(name, async (id?: unknown, uri?: unknown) => {
        const target = await targetOf(client, id, uri);
        if (target) await withProgress(`${name.replace(".", " ")} ${target.id}`, output, (signal) => act(target, signal));
      }),
    );
  };
  command("fretc.explain", ({ id, uri }, signal) => explain(projectAt(uri), id, signal));
  command("fretc.play", ({ uri }, signal) => play(projectAt(uri), signal));
  command("fretc.audit", async ({ id, uri }, signal) => {
    const item = await tests.find(id, uri);
    if (!item) return;
    const source = new vscode.CancellationTokenSource();
    signal.addEventListener("abort", () => source.cancel());
    await tests.run(new vscode.TestRunRequest([item]), source.token);
  });
  command("fretc.verify", ({ uri }) => task(uri, "verify", verifyArguments(projectAt(uri), uri.fsPath)));
  command("fretc.test", ({ id, uri }) => task(uri, "test", testArguments(projectAt(uri), id, uri.fsPath)));
  await restart();
}

function projectAt(uri: vscode.Uri) {
  return projectOf(uri.fsPath, vscode.workspace.getWorkspaceFolder(uri)?.uri.fsPath);
}

/** The target of a command, whose file is saved; undefined where there is no requirement. */
async function targetOf(client: Server, id: unknown, uri: unknown): Promise<Target | undefined> {
  const editor = vscode.window.activeTextEditor;
  const file = typeof uri === "string" ? vscode.Uri.parse(uri, true) : editor?.document.uri;
  if (file?.scheme !== "file") return undefined;
  await vscode.workspace.saveAll(false);
  if (typeof id === "string") return { id, uri: file };
  const requirements = await client.requirements(file);
  const line = editor?.selection.active.line ?? 0;
  const present = requirements.find((each) => line <= each.whole.end.line) ?? requirements.at(-1);
  if (!present) {
    void vscode.window.showInformationMessage("This file has no requirement, or the language server does not run.");
    return undefined;
  }
  return { id: present.id satisfies Requirement["id"], uri: file };
}

async function withProgress(
  title: string,
  output: vscode.OutputChannel,
  act: (signal: AbortSignal) => Promise<void>,
): Promise<void> {
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  await vscode.window.withProgress(options, async (_, token) => {
    const stopper = new AbortController();
    token.onCancellationRequested(() => stopper.abort());
    try {
      await act(stopper.signal);
    } catch (error) {
      if (error instanceof CanceledError) return;
      const text = error instanceof Error ? error.message : String(error);
      output.appendLine(text);
      const first = text.split("\n", 1)[0]!;
      if (error instanceof NoPageError) void showOutput(first, output);
      else void complain(first, output);
    }
  });
}

async function showOutput(message: string, output: vscode.OutputChannel): Promise<void> {
  if (await vscode.window.showErrorMessage(message, "Show the Output")) output.show();
}

/** Run fretc where the user sees its output. No shell reads the arguments. */
async function task(uri: vscode.Uri, name: string, args: string[]): Promise<void> {
  const { folder } = projectAt(uri);
  const scope = vscode.workspace.getWorkspaceFolder(uri) ?? vscode.TaskScope.Workspace;
  const execution = new vscode.ProcessExecution(programPath(), args, { cwd: folder });
  const definition = { type: "fretc", command: name };
  await vscode.tasks.executeTask(new vscode.Task(definition, scope, name, "fretc", execution, []));
}
