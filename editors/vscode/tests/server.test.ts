// The real server on standard input and output: FRETC is the command, as a JSON list.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import * as protocol from "vscode-languageclient/node";

const SENTENCE = "whenever near the robot shall within 2 ticks satisfy stopped";
const command = process.env["FRETC"];

test("the server answers what the extension asks", { skip: command ? false : "FRETC is not set" }, async () => {
  const [program, ...args] = JSON.parse(command!) as string[];
  const folder = mkdtempSync(join(tmpdir(), "fretc-"));
  const file = join(folder, "r.fret");
  writeFileSync(file, `+++\nid = "R1"\ntitle = "Stop"\n+++\n${SENTENCE}\n`);
  const server = spawn(program!, [...args, "lsp"], { cwd: folder, stdio: ["pipe", "pipe", "inherit"] });
  const connection = protocol.createMessageConnection(
    new protocol.StreamMessageReader(server.stdout),
    new protocol.StreamMessageWriter(server.stdin),
  );
  try {
    connection.listen();
    const rootUri = pathToFileURL(folder).href;
    const { capabilities } = await connection.sendRequest<{ capabilities: Record<string, any> }>("initialize", {
      processId: process.pid, rootUri, workspaceFolders: [{ uri: rootUri, name: "root" }], capabilities: {},
    });
    void connection.sendNotification("initialized", {});

    // The client would register the server's commands, and fail, because the extension has the same.
    assert.deepEqual((capabilities["executeCommandProvider"]?.commands ?? []).filter((name: string) => name.startsWith("fretc.")), []);
    const scopes = JSON.parse(readFileSync("package.json", "utf8")).contributes.semanticTokenScopes[0].scopes;
    const types = capabilities["semanticTokensProvider"].legend.tokenTypes as string[];
    assert.deepEqual(Object.keys(scopes).filter((name) => !types.includes(name)), []);

    // Of a file that is not open, as the test explorer asks.
    const symbols = await connection.sendRequest("textDocument/documentSymbol", { textDocument: { uri: pathToFileURL(file).href } });
    const [{ name, detail, selectionRange }] = symbols as [{ name: string; detail: string; selectionRange: unknown }];
    const end = { line: 4, character: SENTENCE.length };
    assert.deepEqual({ name, detail, selectionRange }, { name: "R1", detail: "Stop", selectionRange: { start: { line: 4, character: 0 }, end } });
    await connection.sendRequest("shutdown");
    void connection.sendNotification("exit");
  } finally {
    connection.dispose();
    server.kill();
    rmSync(folder, { recursive: true });
  }
});
