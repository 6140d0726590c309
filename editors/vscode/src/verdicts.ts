// The results of an audit, as outcomes of tests.

export type Outcome = "passed" | "failed" | "errored";

export interface Judgement {
  readonly requirement: string;
  readonly outcome: Outcome;
  /** A line for each run: verdict and reason. */
  readonly text: string;
}

interface RunResult {
  readonly run: string;
  readonly requirement: string;
  readonly verdict: string;
  readonly reason: string;
}

interface Estimate {
  readonly requirement: string;
  readonly answer: string;
  readonly reason: string;
}

const OUTCOMES: Readonly<Record<string, Outcome>> = {
  satisfied: "passed",
  supported: "passed",
  violated: "failed",
  refuted: "failed",
};
/** Worst last. */
const ORDER: readonly Outcome[] = ["passed", "errored", "failed"];

/** The outcome of a verdict: a test passes only where the run shows that the requirement holds. */
export function outcomeOf(verdict: string): Outcome {
  return Object.hasOwn(OUTCOMES, verdict) ? OUTCOMES[verdict]! : "errored";
}

/**
 * Parse what `fretc audit --format json` prints; a requirement of several runs has the worst outcome.
 * @throws Error the text has another form.
 */
export function judgements(json: string): Map<string, Judgement> {
  const document: unknown = JSON.parse(json);
  const results = Array.isArray(document) ? document : field(document, "results");
  const estimates = Array.isArray(document) ? [] : field(document, "probabilities");
  const all = new Map<string, Judgement>();
  for (const { run, requirement, verdict, reason } of results as RunResult[]) {
    const outcome = outcomeOf(verdict);
    const before = all.get(requirement);
    const line = `${verdict}: ${reason} (${run})`;
    all.set(requirement, {
      requirement,
      outcome: before ? worse(before.outcome, outcome) : outcome,
      text: before ? `${before.text}\n${line}` : line,
    });
  }
  for (const { requirement, answer, reason } of estimates as Estimate[]) {
    all.set(requirement, { requirement, outcome: outcomeOf(answer), text: `${answer}: ${reason}` });
  }
  return all;
}

function worse(a: Outcome, b: Outcome): Outcome {
  return ORDER.indexOf(a) > ORDER.indexOf(b) ? a : b;
}

function field(document: unknown, name: string): unknown[] {
  const value = (document as Record<string, unknown> | null)?.[name];
  if (!Array.isArray(value)) throw new Error(`the output of fretc audit has no list \`${name}\``);
  return value;
}
