import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { test } from "node:test";
import { activate } from "../src/extension";

const { calls } = createRequire(join(process.cwd(), "package.json"))("vscode");
const manifest = JSON.parse(readFileSync("package.json", "utf8"));
const source = readFileSync("src/extension.ts", "utf8");

test("in a workspace that is not trusted nothing starts but the wait for trust", async () => {
  const context = { subscriptions: [] };
  await activate(context as never);
  assert.deepEqual([calls.trustHandlers, calls.commands, context.subscriptions.length], [1, [], 1]);
});

test("the commands of the manifest are those that the extension registers", () => {
  const registered = [...source.matchAll(/(?:registerCommand|[^.]command)\("(fretc\.\w+)"/g)].map((match) => match[1]);
  const contributed = manifest.contributes.commands.map(({ command }: { command: string }) => command);
  assert.deepEqual(registered.sort(), contributed.sort());
});

test("what could start a program cannot be set by a workspace that is not trusted", () => {
  const { untrustedWorkspaces } = manifest.capabilities;
  assert.equal(untrustedWorkspaces.supported, "limited");
  assert.deepEqual(untrustedWorkspaces.restrictedConfigurations, Object.keys(manifest.contributes.configuration.properties));
});
