import assert from "node:assert/strict";
import { test } from "node:test";
import { judgements, outcomeOf } from "../src/verdicts";

const result = (requirement: string, verdict: string, run = "a.mcap") => ({ run, requirement, verdict, reason: "why" });

test("a test passes only if the requirement is satisfied or supported", () => {
  const verdicts = "satisfied supported violated refuted inconclusive vacuous no_data constructor toString".split(" ");
  assert.deepEqual(verdicts.map(outcomeOf), ["passed", "passed", "failed", "failed", ...Array(5).fill("errored")]);
});

test("the worst of several runs counts, and each run has a line", () => {
  const all = judgements(
    JSON.stringify([
      result("R1", "satisfied"), result("R1", "violated", "b.mcap"), result("R1", "inconclusive", "c.mcap"),
      result("R2", "vacuous"), result("R2", "satisfied"),
    ]),
  );
  assert.equal(all.get("R1")?.outcome, "failed");
  assert.equal(all.get("R1")?.text, "satisfied: why (a.mcap)\nviolated: why (b.mcap)\ninconclusive: why (c.mcap)");
  assert.equal(all.get("R2")?.outcome, "errored");
  assert.equal(all.get("R3"), undefined);
});

test("a requirement with a probability has the answer over all runs", () => {
  const document = {
    results: [result("R1", "satisfied"), result("R2", "inconclusive")],
    probabilities: [{ requirement: "R2", answer: "refuted", reason: "too rare" }],
  };
  const all = judgements(JSON.stringify(document));
  assert.deepEqual(all.get("R2"), { requirement: "R2", outcome: "failed", text: "refuted: too rare" });
  assert.equal(all.get("R1")?.outcome, "passed");
});

test("another output is an error, not a verdict", () => {
  for (const text of ["", "{}", "null", '{"results": []}', "[", '"satisfied"']) assert.throws(() => judgements(text));
});
