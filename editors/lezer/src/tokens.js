// The words of FRETish, as the lexer of fretc reads them.
import { ExternalTokenizer } from "@lezer/lr";
import * as terms from "./parser.terms.js";

const WORD = /[A-Za-z](?:[A-Za-z0-9_.%]*[A-Za-z0-9_%])?/y;
const KEY_WORD = /[A-Za-z]+(?![\w%]|\.\w)/y;
const TIME_UNIT = /^(?:ticks?|(?:micro|milli)?sec(?:ond)?s?|minutes?|hours?)$/;
const NUMBER = /(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?/y;
/** The units of fretc, without `1`. */
const UNITS = "mrad|min|rad|deg|kPa|bar|km|dm|cm|mm|um|ft|kn|ms|us|ns|kg|mA|Nm|Pa|mV|Hz|%|m|s|h|g|A|K|N|V|W";
const POWERED = `(?:${UNITS})(?:\\^?-?[0-9]{1,2})?(?![\\w%]|\\.\\w)`;
const QUANTITY = new RegExp(
  "(?:0|[1-9][0-9]{0,59})(?:\\.[0-9]{1,60})?(?:[eE][+-]?[0-9]{1,3}(?![0-9.]))?" +
    `[ \\t\\r\\n\\f\\v\\u00a0]*${POWERED}(?:[*/]${POWERED})*`,
  "y",
);
const FENCE = /\+\+\+[ \t]*(?:\r?\n|$)/y;
const AMOUNT = "(0|[1-9][0-9]*)(?:\\.([0-9]+))?[ \\t\\r\\n\\f\\v\\u00a0]*";
const IN_WORDS = new RegExp(`${AMOUNT}(tick|(?:micro|milli)?sec|minute|hour)(?:(?<=sec)ond)?s?(?![\\w%]|\\.\\w)`, "iy");
const IN_SYMBOLS = new RegExp(`${AMOUNT}(us|ms|s|min|h)`, "y");
/** Nanoseconds of the units of time, from the largest on. */
const UNITS_OF_TIME = [
  [["h", "hour"], 3_600_000_000_000n],
  [["min", "minute"], 60_000_000_000n],
  [["s", "sec"], 1_000_000_000n],
  [["ms", "millisec"], 1_000_000n],
  [["us", "microsec"], 1_000n],
];
const MOST = 10n ** 15n;
/** Words that are reserved, and that no sentence uses. */
const UNUSED = new Set(["what"]);
/** Key word in lower case → its term. */
const KEY_WORDS = new Map(
  (
    "After Always And At Before During Eventually Except Finally First For If Immediately In Initially Is Last Mod Mode Never Next " +
    "Not Of Only Or Previous Same Satisfy Shall The Then Timepoint Unless Until Upon When Whenever Where While With Within Xor"
  )
    .split(" ")
    .map((name) => [name.toLowerCase(), terms[name]]),
)
  .set("occurrence", terms.OccurrenceWord)
  .set("probability", terms.ProbabilityWord);
/** Characters that follow a number and may belong to it: they hold every unit. */
const AFTER_DIGITS = 200;

const text = (input, from, accepts, most = Infinity) => {
  let characters = "";
  for (let offset = from; characters.length < most; offset += 1) {
    const code = input.peek(offset);
    if (code < 0 || !accepts(code)) break;
    characters += String.fromCharCode(code);
  }
  return characters;
};
const match = (pattern, characters) => {
  pattern.lastIndex = 0;
  return pattern.exec(characters)?.[0];
};
const isDigit = (code) => code >= 48 && code <= 57;
const isLetter = (code) => (code >= 65 && code <= 90) || (code >= 97 && code <= 122);
const isInWord = (code) => isLetter(code) || isDigit(code) || code === 95 || code === 46 || code === 37;
const accept = (input, term, length) => input.acceptToken(term, length);

function word(input) {
  const characters = text(input, 0, isInWord);
  const key = match(KEY_WORD, characters);
  const lower = key?.toLowerCase();
  if (key === "true" || key === "false") accept(input, key === "true" ? terms.True : terms.False, key.length);
  else if (lower === "true" || lower === "false") accept(input, lower === "true" ? terms.IsTrue : terms.IsFalse, key.length);
  else if (lower && (UNUSED.has(lower) || TIME_UNIT.test(lower))) return;
  else if (lower && KEY_WORDS.has(lower)) accept(input, KEY_WORDS.get(lower), key.length);
  else accept(input, terms.Identifier, match(WORD, characters).length);
}

const numberAndRest = (input) => {
  const digits = text(input, 0, isDigit);
  return digits + text(input, digits.length, () => true, AFTER_DIGITS);
};

function number(input) {
  const characters = numberAndRest(input);
  const quantity = match(QUANTITY, characters);
  if (quantity) accept(input, terms.Quantity, quantity.length);
  else accept(input, terms.Number, match(NUMBER, characters).length);
}

/** A whole number of ticks, or of a unit of time or a smaller one. */
export const duration = new ExternalTokenizer((input) => {
  if (!isDigit(input.next)) return;
  const characters = numberAndRest(input);
  const quantity = match(QUANTITY, characters);
  const pattern = quantity ? IN_SYMBOLS : IN_WORDS;
  const length = match(pattern, characters)?.length;
  if (!length || (quantity && quantity.length !== length)) return;
  pattern.lastIndex = 0;
  const [, whole, decimals = "", unit] = pattern.exec(characters);
  if (isWhole(whole, decimals, unit.toLowerCase())) accept(input, terms.Duration, length);
});

function isWhole(whole, decimals, unit) {
  const denominator = 10n ** BigInt(decimals.length);
  const numerator = BigInt(whole + decimals);
  if (numerator % denominator === 0n) return numerator / denominator < MOST;
  const at = UNITS_OF_TIME.findIndex(([names]) => names.includes(unit));
  if (at < 0) return false;
  const nanoseconds = numerator * UNITS_OF_TIME[at][1];
  const smaller = UNITS_OF_TIME.slice(at + 1).find(([, size]) => nanoseconds % (denominator * size) === 0n);
  return smaller !== undefined && nanoseconds / (denominator * smaller[1]) < MOST;
}

function quoted(input) {
  const characters = text(input, 1, (code) => code !== 34);
  if (input.peek(characters.length + 1) !== 34) return;
  const isName = characters !== "" && !characters.includes("\n");
  accept(input, isName ? terms.QuotedName : terms.QuotedText, characters.length + 2);
}

export const words = new ExternalTokenizer((input) => {
  if (isLetter(input.next)) word(input);
  else if (isDigit(input.next)) number(input);
  else if (input.next === 34) quoted(input);
});

const isAtLineStart = (input, offset) => {
  const before = input.peek(offset - 1);
  return before < 0 || before === 10 || before === 0xfeff;
};
const lineRest = (input, offset) => {
  const line = text(input, offset, (code) => code !== 10);
  return input.peek(offset + line.length) === 10 ? `${line}\n` : line;
};

/** A line of `+++`. */
export const fence = new ExternalTokenizer((input) => {
  if (input.next === 43 && isAtLineStart(input, 0)) {
    const line = match(FENCE, lineRest(input, 0));
    if (line) accept(input, terms.Fence, line.trimEnd().length);
  }
});

/** All lines up to the next fence. */
export const headerText = new ExternalTokenizer((input) => {
  let length = 0;
  while (input.peek(length) >= 0) {
    if (isAtLineStart(input, length) && match(FENCE, lineRest(input, length))) break;
    length += lineRest(input, length).length;
  }
  if (length) accept(input, terms.HeaderText, length);
});
