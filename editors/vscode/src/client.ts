// The language client: it starts `fretc lsp`, and says what to do where that fails.

import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";

const DOCUMENTS = [
  { scheme: "file", language: "fretish" },
  { scheme: "file", pattern: "**/{bindings,hazards,waivers,fretc}.toml" },
  { scheme: "file", pattern: "**/fretc.lock" },
];

export class Server implements vscode.Disposable {
  private client: LanguageClient | undefined;

  constructor(private readonly output: vscode.OutputChannel) {}

  /** Start the server, or start it again. */
  async start(path: string): Promise<void> {
    await this.stop();
    const client = new LanguageClient(
      "fretc",
      "FRETish",
      { command: path, args: ["lsp"] }, // with a transport the client would add an option --stdio
      {
        documentSelector: DOCUMENTS,
        outputChannel: this.output,
        initializationFailedHandler: () => false,
        markdown: { isTrusted: false, supportHtml: false },
      },
    );
    this.client = client;
    try {
      await client.start();
    } catch (error) {
      this.output.appendLine(String(error));
      await complain(`\`${path} lsp\` could not be started. Install it with: pip install 'fretc[lsp]'`, this.output);
    }
  }

  async stop(): Promise<void> {
    const client = this.client;
    this.client = undefined;
    await client?.dispose().catch(() => undefined);
  }

  /** The requirements of a file, which need not be open; none while the server does not run. */
  async requirements(uri: vscode.Uri): Promise<Requirement[]> {
    if (!this.client?.isRunning()) return [];
    const parameters = { textDocument: { uri: this.client.code2ProtocolConverter.asUri(uri) } };
    const symbols = await this.client.sendRequest<Symbol[] | null>("textDocument/documentSymbol", parameters);
    return (symbols ?? []).map(({ name, detail, range, selectionRange }) => ({
      id: name,
      title: detail ?? "",
      whole: rangeOf(range),
      sentence: rangeOf(selectionRange),
    }));
  }

  dispose(): void {
    void this.stop();
  }
}

export interface Requirement {
  readonly id: string;
  readonly title: string;
  /** Header and sentence. */
  readonly whole: vscode.Range;
  readonly sentence: vscode.Range;
}

interface Position {
  readonly line: number;
  readonly character: number;
}

interface Symbol {
  readonly name: string;
  readonly detail?: string;
  readonly range: { start: Position; end: Position };
  readonly selectionRange: { start: Position; end: Position };
}

function rangeOf({ start, end }: Symbol["range"]): vscode.Range {
  return new vscode.Range(start.line, start.character, end.line, end.character);
}

/** Show an error with ways to go on. */
export async function complain(message: string, output: vscode.OutputChannel): Promise<void> {
  const choice = await vscode.window.showErrorMessage(message, "Set the Path", "Show the Output");
  if (choice === "Set the Path") await vscode.commands.executeCommand("workbench.action.openSettings", "fretc.path");
  if (choice === "Show the Output") output.show();
}
