import assert from "node:assert/strict";
import { test } from "node:test";
import { type Explanation, explanationPage, hasStrictPolicy } from "../src/explanation";

const HOSTILE = `<script>alert("x")</script>'&`;
const explanation: Explanation = {
  id: HOSTILE, title: HOSTILE, sentence: HOSTILE, meaning: `\`${HOSTILE}\` is true`, ft_infinite: HOSTILE, ft_finite: "", pt: "",
  diagram: { words: HOSTILE }, notes: [HOSTILE],
  traces: [
    {
      verdict: "violated", decided: 2, reason: HOSTILE,
      rows: [
        { first: 0, last: 1, values: { [HOSTILE]: true, x: 2.5 }, repeats: false },
        { first: 2, last: 2, values: { [HOSTILE]: false, x: null }, repeats: true },
      ],
    },
  ],
};

test("a text of a requirement never becomes markup, and no script may run", () => {
  const page = explanationPage(explanation, `<svg onload="alert(1)"/>`, "abc");
  assert.ok(!/<script|onload/i.test(page));
  assert.ok(page.includes(`content="default-src 'none'; img-src data:; style-src 'nonce-abc'"`));
  assert.ok(page.includes("&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;&#39;&amp;"));
});

test("a run is a table with a column for each stretch of ticks", () => {
  const page = explanationPage({ ...explanation, traces: explanation.traces }, "", "abc");
  assert.ok(page.includes(`<th scope="col">0 to 1</th><th scope="col" class="decides">2 …</th>`));
  assert.ok(page.includes("<td>2.5</td><td>?</td>"));
  assert.ok(page.includes("decided at tick 2"));
  assert.ok(!page.includes("<img"));
});

test("a page of play is shown only with its policy", () => {
  const page = (policy: string) => `<head><meta http-equiv="Content-Security-Policy" content="${policy}"></head>`;
  assert.ok(hasStrictPolicy(page("default-src 'none'; script-src 'sha256-x'")));
  assert.ok(!hasStrictPolicy(page("default-src 'none'; script-src 'unsafe-inline'")));
  assert.ok(!hasStrictPolicy(page("default-src *;")));
  assert.ok(!hasStrictPolicy("<html></html>"));
});
