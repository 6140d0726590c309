// Parses texts. Standard input: a JSON list. Output: for each text the tree, and the offsets of its error nodes.
import { readFileSync } from "node:fs";
import { highlightCode, classHighlighter } from "@lezer/highlight";
import { parser } from "../src/index.js";

const result = (text) => {
  const tree = parser.parse(text);
  const errors = [];
  tree.iterate({ enter: (node) => void (node.type.isError && errors.push(node.from)) });
  const colours = [];
  highlightCode(text, tree, classHighlighter, (part, classes) => classes && colours.push([part, classes]), () => {});
  return { tree: String(tree), errors, colours };
};
process.stdout.write(JSON.stringify(JSON.parse(readFileSync(0, "utf8")).map(result)));
