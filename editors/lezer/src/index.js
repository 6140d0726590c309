export { parser } from "./parser.js";
export { highlighting } from "./highlight.js";
