import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { CanceledError, NotStartedError, run } from "../src/program";
import { auditArguments, explainArguments, projectOf, verifyArguments } from "../src/project";

test("status and both outputs come back, and no shell reads the arguments", async () => {
  const script = "console.log(process.argv[1]); console.error('é'); process.exitCode = 3";
  const result = await run(process.execPath, ["-e", script, "$(touch x); `y`"], process.cwd());
  assert.deepEqual(result, { status: 3, stdout: "$(touch x); `y`\n", stderr: "é\n" });
});

test("a program that does not exist and a stopped one are different errors", async () => {
  await assert.rejects(run(join(process.cwd(), "no-such-program"), [], process.cwd()), NotStartedError);
  const stopper = new AbortController();
  const running = run(process.execPath, ["-e", "setInterval(() => {}, 1000)"], process.cwd(), stopper.signal);
  setTimeout(() => stopper.abort(), 50);
  await assert.rejects(running, CanceledError);
});

test("the project of a file is its folder, named from the workspace folder", () => {
  const project = projectOf("/robot/requirements/mission/r01.fret", "/robot");
  assert.deepEqual(project, { folder: "/robot", requirements: "requirements/mission" });
  assert.deepEqual(projectOf("/robot/r.fret", undefined), { folder: "/robot", requirements: "." });
  assert.deepEqual(verifyArguments(project, "/robot/requirements/mission/r01.fret").at(-1), "requirements/mission/r01.fret");
});

test("what a user has written is never read as an option", () => {
  const project = { folder: "/robot", requirements: "requirements" };
  assert.deepEqual(auditArguments(project, "--jobs").slice(-2), ["--", "--jobs"]);
  assert.deepEqual(explainArguments(project, "-h", "d.svg").slice(-2), ["--", "-h"]);
});

test("each project of a workspace folder has its own evidence", () => {
  const output = (requirements: string) => auditArguments({ folder: "/r", requirements }, "a.mcap").slice(5, -2);
  assert.deepEqual(output("requirements"), []);
  assert.deepEqual(output("requirements/mission"), ["-o", "build/mission.json"]);
  assert.deepEqual(output("."), ["-o", "build/evidence.json"]);
});
