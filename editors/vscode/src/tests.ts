// The test explorer: each requirement is a test, and to run it is to audit the chosen log.

import * as vscode from "vscode";
import type { Requirement, Server } from "./client";
import { CanceledError, run } from "./program";
import { type Project, auditArguments, projectOf } from "./project";
import { chooseLog, chosenLog, programPath } from "./settings";
import { type Judgement, judgements } from "./verdicts";

const FILES = "**/*.fret";
const LEFT_OUT = "**/{node_modules,build,.*}/**";

export class RequirementTests implements vscode.Disposable {
  readonly controller = vscode.tests.createTestController("fretc", "Requirements");
  private readonly disposables: vscode.Disposable[] = [this.controller];

  constructor(
    private readonly server: Server,
    private readonly output: vscode.OutputChannel,
  ) {
    this.controller.createRunProfile(
      "Audit the chosen log",
      vscode.TestRunProfileKind.Run,
      (request, token) => this.run(request, token),
      true,
    );
    this.controller.refreshHandler = () => this.refresh();
    const watcher = vscode.workspace.createFileSystemWatcher(FILES);
    this.disposables.push(
      watcher,
      watcher.onDidCreate((uri) => this.read(uri)),
      watcher.onDidChange((uri) => this.read(uri)),
      watcher.onDidDelete((uri) => this.controller.items.delete(uri.toString())),
    );
  }

  /** List the requirements of all files of the workspace. */
  async refresh(): Promise<void> {
    const files = await vscode.workspace.findFiles(FILES, LEFT_OUT);
    const present = new Set(files.map(String));
    this.controller.items.forEach((item) => present.has(item.id) || this.controller.items.delete(item.id));
    for (const file of files) await this.read(file);
  }

  /** The tests of some requirement, to run it alone; undefined if there is none. */
  async find(id: string, uri: vscode.Uri): Promise<vscode.TestItem | undefined> {
    await this.read(uri);
    return this.controller.items.get(uri.toString())?.children.get(testId(uri, id));
  }

  dispose(): void {
    for (const disposable of this.disposables) disposable.dispose();
  }

  private async read(uri: vscode.Uri): Promise<void> {
    const requirements = await this.server.requirements(uri);
    const path = vscode.workspace.asRelativePath(uri);
    const file = this.controller.items.get(uri.toString()) ?? this.controller.createTestItem(uri.toString(), path, uri);
    file.children.replace(requirements.map((each) => this.item(each, uri)));
    this.controller.items.add(file);
  }

  private item({ id, title, sentence }: Requirement, uri: vscode.Uri): vscode.TestItem {
    const item = this.controller.createTestItem(testId(uri, id), id, uri);
    item.description = title;
    item.range = sentence;
    return item;
  }

  /** Audit the projects of the tests: one audit gives the verdicts of a whole project. */
  async run(request: vscode.TestRunRequest, token: vscode.CancellationToken): Promise<void> {
    const items = this.leaves(request);
    const testRun = this.controller.createTestRun(request);
    const stopper = new AbortController();
    token.onCancellationRequested(() => stopper.abort());
    try {
      await vscode.workspace.saveAll(false);
      for (const { project, tests } of byProject(items)) {
        for (const test of tests) testRun.started(test);
        const answer = await this.audit(project, tests[0]!.uri!, testRun, stopper.signal);
        if (answer === undefined) for (const test of tests) testRun.skipped(test);
        else for (const test of tests) report(testRun, test, answer);
      }
    } finally {
      testRun.end();
    }
  }

  private leaves({ include, exclude }: vscode.TestRunRequest): vscode.TestItem[] {
    const items: vscode.TestItem[] = [];
    const add = (item: vscode.TestItem) => {
      if (exclude?.includes(item)) return;
      if (item.children.size) item.children.forEach(add);
      else if (item.range) items.push(item);
    };
    if (include) include.forEach(add);
    else this.controller.items.forEach(add);
    return items;
  }

  /** The judgements by requirement, or the reason why there are none; undefined if it was stopped. */
  private async audit(
    project: Project,
    scope: vscode.Uri,
    testRun: vscode.TestRun,
    signal: AbortSignal,
  ): Promise<Answer | undefined> {
    const log = chosenLog(scope) ?? (await chooseLog(scope));
    if (log === undefined) return undefined;
    const args = auditArguments(project, log);
    try {
      const { stdout, stderr } = await run(programPath(), args, project.folder, signal);
      testRun.appendOutput(stderr.replaceAll(/\r?\n/g, "\r\n"));
      return stdout.trim() ? { judgements: judgements(stdout), mistakes: stderr } : { mistakes: stderr };
    } catch (error) {
      if (error instanceof CanceledError) return undefined;
      this.output.appendLine(String(error));
      return { mistakes: error instanceof Error ? error.message : String(error) };
    }
  }
}

interface Answer {
  readonly judgements?: Map<string, Judgement>;
  /** What fretc has printed on standard error. */
  readonly mistakes: string;
}

function testId(uri: vscode.Uri, id: string): string {
  return `${uri.toString()}#${id}`;
}

function report(testRun: vscode.TestRun, test: vscode.TestItem, { judgements, mistakes }: Answer): void {
  const judgement = judgements?.get(test.label);
  const text = judgement?.text ?? `no verdict\n${mistakes.trim()}`;
  const outcome = judgement?.outcome ?? "errored";
  testRun.appendOutput(`${test.label} ${text}`.replaceAll(/\r?\n/g, "\r\n") + "\r\n", undefined, test);
  if (outcome === "passed") {
    testRun.passed(test);
    return;
  }
  const message = new vscode.TestMessage(text);
  if (test.uri && test.range) message.location = new vscode.Location(test.uri, test.range);
  testRun[outcome](test, message);
}

function byProject(items: readonly vscode.TestItem[]): { project: Project; tests: vscode.TestItem[] }[] {
  const groups = new Map<string, { project: Project; tests: vscode.TestItem[] }>();
  for (const test of items) {
    const uri = test.uri!;
    const project = projectOf(uri.fsPath, vscode.workspace.getWorkspaceFolder(uri)?.uri.fsPath);
    const key = JSON.stringify(project);
    const group = groups.get(key) ?? { project, tests: [] };
    group.tests.push(test);
    groups.set(key, group);
  }
  return [...groups.values()];
}
