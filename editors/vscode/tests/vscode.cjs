// A stand-in for the module `vscode`: what a test looks at is recorded, all else is an empty class.
const Module = require("node:module");

const calls = { commands: [], trustHandlers: 0, isTrusted: false };
class Empty {}
const known = {
  calls,
  workspace: {
    get isTrusted() {
      return calls.isTrusted;
    },
    onDidGrantWorkspaceTrust: () => {
      calls.trustHandlers += 1;
      return { dispose() {} };
    },
  },
  commands: { registerCommand: (name) => calls.commands.push(name) },
  window: {},
  tests: {},
  tasks: {},
};
const vscode = new Proxy(known, {
  get: (target, name) => (name in target ? target[name] : class extends Empty {}),
});

const load = Module._load;
Module._load = function (request, ...rest) {
  return request === "vscode" ? vscode : load.call(this, request, ...rest);
};
