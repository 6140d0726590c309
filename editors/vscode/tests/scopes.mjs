// Tokenizes texts by the TextMate grammar, as VS Code does.
// Standard input: a JSON list of texts. Output: for each text a list of [start, end, scope],
// offsets in UTF-16 code units, in which adjacent tokens of one scope are not joined.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

await oniguruma.loadWASM(readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")));
const path = new URL("../syntaxes/fretish.tmLanguage.json", import.meta.url);
const registry = new Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => parseRawGrammar(readFileSync(path, "utf8"), "grammar.json"),
});
const grammar = await registry.loadGrammar("source.fretish");

const tokens = (text) => {
  let state = INITIAL;
  let offset = 0;
  const all = [];
  for (const line of text.split("\n")) {
    const result = grammar.tokenizeLine(line, state);
    state = result.ruleStack;
    for (const { startIndex, endIndex, scopes } of result.tokens) {
      all.push([offset + startIndex, Math.min(offset + endIndex, offset + line.length), scopes.at(-1)]);
    }
    offset += line.length + 1;
  }
  return all;
};
process.stdout.write(JSON.stringify(JSON.parse(readFileSync(0, "utf8")).map(tokens)));
