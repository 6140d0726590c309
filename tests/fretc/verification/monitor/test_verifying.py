"""Monitors are proved from their text; what is wrong, or may hide something, is never proved."""

import random
import re
from collections.abc import Sequence

import pytest

from compiler.formalization.letters import Valuation
from compiler.logic.claims import ClaimOutcome, ClaimResult, ClaimTrace, refuted
from compiler.targets.python import monitor as target
from fretc.verification.monitor.verifying import NotAMonitorError
from monitors.kernel import Monitor
from monitors.loading import load
from monitors.source_text import kernel
from tests.each import each
from tests.effort import FULL, some
from tests.meaning import COUNTING
from tests.monitoring import emitted, requirement, with_step, without_step
from tests.proofs import verified
from tests.strategies import Template, few_templates, templates

WITHIN = "whenever p the sw shall within 3 ticks satisfy q"
FOR = "when p the sw shall for 3 ticks satisfy q"
LAYOUT = "it is not laid out as fretc writes it"
RUNTIME = "its runtime part is not the one of this version of fretc"


def check(sentence: str, text: str | None = None, limit: int = 10**6) -> ClaimOutcome:
    return verified(requirement(sentence), emitted(sentence) if text is None else text, limit)


def edited(text: str, *edits: tuple[str, str]) -> str:
    """The text with the one place of each edit changed, below the run time.

    A change of the approximation's tick is one of the step that has it in it.
    """
    place = text.index("# The requirements ---")
    head, own = text[:place], without_step(text)[place:]
    for old, new in edits:
        assert own.count(old) == 1, (old, own.count(old))
        own = own.replace(old, new)
    return with_step(head + own)


def reason(outcome: ClaimOutcome) -> str:
    """Why it is not checked."""
    assert outcome.result is ClaimResult.NOT_CHECKED, outcome
    return outcome.detail


SIZES = re.compile(
    r"the same at every tick of every trace \((\d+) states, (\d+) steps\); "
    r"its column program agrees on (\d+) random ticks"
)


def sizes(outcome: ClaimOutcome) -> tuple[int, ...]:
    """Of a proof: states, steps, and random ticks."""
    assert outcome.result is ClaimResult.PROVED, outcome
    match = SIZES.match(outcome.detail)
    assert match is not None
    return tuple(map(int, match.groups()))


def disagreement(outcome: ClaimOutcome) -> ClaimTrace:
    """The trace at whose last tick the signals are wrong."""
    assert outcome.result is ClaimResult.COUNTEREXAMPLE, outcome
    assert outcome.detail.endswith(" on a trace")
    assert outcome.trace is not None
    return outcome.trace


def judged_wrongly(outcome: ClaimOutcome) -> bool:
    """Whether a trace shows another judgement than that of the sentence."""
    return outcome.result is ClaimResult.COUNTEREXAMPLE and "that shows it has" in outcome.detail


# What is right --------------------------------------------------------------------------------


@pytest.mark.slow
@each("template", some(few_templates((0, 1, 2)), 2))
def test_every_template_is_proved(template: Template) -> None:
    assert sizes(check(template.sentence))[2] > 0


@pytest.mark.slow
@pytest.mark.parametrize("n", [3, 20])
def test_templates_are_proved_at_longer_bounds(n: int) -> None:
    counting = [template for template in templates((n,)) if template.timing in COUNTING]
    for template in random.Random(n).sample(counting, 24 if FULL else 4):
        assert check(template.sentence).result is ClaimResult.PROVED, template


@pytest.mark.slow
@pytest.mark.parametrize(
    "sentence",
    [
        "in m mode whenever p the sw shall within {} ticks satisfy q",
        "when p the sw shall for {} ticks satisfy q",
        "upon p the sw shall after {} ticks satisfy q",
    ],
)
def test_long_bounds_are_proved_as_they_are(sentence: str) -> None:
    bound = 10_000 if FULL else 300
    states, _, ticks = sizes(check(sentence.format(bound)))
    assert states > bound
    assert ticks > 4 * bound, "the columns are compared on traces that reach the bound"


@pytest.mark.slow
def test_each_requirement_of_one_text_is_proved() -> None:
    sentences = (WITHIN, FOR, "in m mode the sw shall before s satisfy q")
    text = emitted(*sentences)
    for number, sentence in enumerate(sentences, 1):
        outcome = verified(requirement(sentence, f"R{number}"), text)
        assert outcome.result is ClaimResult.PROVED, sentence


def test_of_several_requirements_only_the_wrong_one_is_refuted() -> None:
    text = edited(emitted(WITHIN, FOR), ("since_1 = oldest_1 >= 3", "since_1 = oldest_1 >= 4"))
    assert judged_wrongly(verified(requirement(WITHIN, "R1"), text))
    assert verified(requirement(FOR, "R2"), text).result is ClaimResult.PROVED


NAMES = (
    "door_open tick r1_open r1_broken r1_violation_inevitable first kept_first since_1 oldest_1 "
    "known is_possible m rows refused certain every row Signals Window class not_p x_broken lambda "
    "q"
).split()
THREE_OF_THEM = [*zip(NAMES[::3], NAMES[1::3], NAMES[2::3], strict=True)]


@pytest.mark.slow
@each("names", [("m", name, "q") for name in NAMES] if FULL else THREE_OF_THEM[::2])
def test_names_do_not_confuse_it(names: tuple[str, str, str]) -> None:
    mode, name, answer = names
    response = f'!p & "{answer}"'
    sentence = f'in "{mode}" mode upon "{name}" the sw shall within 2 ticks satisfy {response}'
    assert check(sentence).result is ClaimResult.PROVED


@pytest.mark.slow
@each("id", some(["tick", "is_possible", "Monitor", "3", "a-b", "since_1", "self", "first"], 3))
def test_ids_do_not_confuse_it(id: str) -> None:
    formalized = requirement(WITHIN, id)
    assert verified(formalized, target.text(formalized)).result is ClaimResult.PROVED


def test_a_proof_says_how_much_was_looked_at() -> None:
    assert sizes(check(WITHIN)) == (5, 20, 20 * (4 * 3 + 50))


# What is wrong --------------------------------------------------------------------------------

P, Q, NONE, BOTH = (True, False), (False, True), (False, False), (True, True)
PENDING = "pending (true if it ended there)"
VIOLATED = "violated (false if it ended there)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edits", "word", "expected", "actual"),
    [
        ([(">= 3\n", ">= 4\n")], (P, NONE, NONE, NONE), VIOLATED, PENDING),
        ([(">= 3\n", ">= 2\n")], (P, NONE, NONE), PENDING, VIOLATED),
        (
            [("oldest_1 + 1 if oldest_1 < 3 else 3", "oldest_1 + 1 if oldest_1 < 2 else 2")],
            (P, NONE, NONE, NONE),
            VIOLATED,
            PENDING,
        ),
        ([("elif p and not_q:", "elif p or not_q:")], (NONE,) * 4, PENDING, VIOLATED),
        (
            [("        self.oldest_1 = -1", "        self.oldest_1 = 0")],
            (NONE,) * 3,
            PENDING,
            VIOLATED,
        ),
    ],
)
def test_a_wrong_step_is_refuted_by_a_shortest_trace(
    edits: list[tuple[str, str]], word: tuple[Valuation, ...], expected: str, actual: str
) -> None:
    assert check(WITHIN, edited(emitted(WITHIN), *edits)) == refuted(
        f"the shortest trace that shows it has {len(word)} ticks; after it, {actual}, and should "
        f"be {expected}",
        ClaimTrace(("p", "q"), word),
    )


def test_a_monitor_of_another_sentence_with_the_same_id_is_refuted() -> None:
    assert judged_wrongly(check(WITHIN, emitted(WITHIN.replace("3", "2"))))
    assert judged_wrongly(check(WITHIN, emitted(WITHIN.replace("whenever", "upon"))))
    assert judged_wrongly(check("the sw shall satisfy q", emitted("the sw shall satisfy r")))


def test_a_wrong_column_program_disagrees_with_the_steps() -> None:
    text = edited(emitted(WITHIN), ("p & not_q, 3, every)", "p & not_q, 4, every)"))
    assert disagreement(check(WITHIN, text)).names == ("p", "q")


@pytest.mark.slow
def test_a_wrong_column_program_is_found_at_a_long_bound() -> None:
    right = 5000 if FULL else 200
    sentence = f"when p the sw shall for {right} ticks satisfy q"
    text = emitted(sentence)
    place = text.index("def columns")
    for bound in (right - 1, right + 1):
        wrong = text[:place] + text[place:].replace(f"0, {right}, every)", f"0, {bound}, every)")
        assert wrong != text
        assert disagreement(check(sentence, wrong)), bound


@pytest.mark.slow
@each("signal", ["trigger", "violation", "obligation_pending", "satisfied_forever", "answer"])
def test_every_signal_of_the_column_program_is_compared(signal: str) -> None:
    sentence = "before m mode the sw shall within 2 ticks satisfy q"
    text = emitted(sentence)
    wrong = re.sub(rf"(?m)^( +{signal}=).*,$", r"\1every & 1,", text)
    assert wrong != text
    assert disagreement(check(sentence, wrong))


def test_a_column_program_that_fails_or_tells_of_ticks_beyond_the_trace_disagrees() -> None:
    for new in ("once(p, None, None, every)", "2361183241434822606848"):
        text = edited(emitted(WITHIN), ("trigger=p,", f"trigger={new},"))
        assert disagreement(check(WITHIN, text)), new


def test_a_step_that_takes_what_is_unknown_for_certain_disagrees_with_the_columns() -> None:
    """With all values known, `not q` and `not_q` are one."""
    text = edited(emitted(WITHIN), ("elif p and not_q:", "elif p and not q:"))
    assert any(None in values for values in disagreement(check(WITHIN, text)).rows)


def test_the_trace_of_a_disagreement_names_the_atoms_in_their_order() -> None:
    """The monitor may list its propositions in another order than the sentence."""
    sentence = "whenever p the sw shall within 3 ticks satisfy q"
    other = "the sw shall always satisfy q | z"
    text = emitted(other, sentence)
    wrong = edited(text, ("p & not_q, 3, every)", "p & not_q, 4, every)"))
    trace = disagreement(verified(requirement(sentence, "R2"), wrong))
    assert trace.names == ("p", "q", "z")
    *_, last = trace.rows
    assert last[1] is not True, "an overdue demand shows where q does not come"


# What is not checked --------------------------------------------------------------------------


def test_predicates_about_other_ticks_are_not_checked() -> None:
    why = reason(check("whenever occurred(3, p) the sw shall satisfy q"))
    assert why == "`occurred` refers to other ticks, and the automaton reads one tick at a time"


@pytest.mark.slow
def test_more_than_twelve_propositions_are_not_checked() -> None:
    def of(count: int) -> str:
        return f"the sw shall always satisfy {' | '.join(f'a{i}' for i in range(count))}"

    assert check(of(12)).result is ClaimResult.PROVED
    assert reason(check(of(13))) == "13 propositions, more than 12"


def test_more_states_than_the_limit_are_not_checked() -> None:
    assert "more than 10 states" in reason(check(WITHIN.replace("3", "100"), limit=10))


def test_a_monitor_of_other_requirements_is_not_checked() -> None:
    outcome = verified(requirement(WITHIN, "R2"), emitted(WITHIN))
    assert reason(outcome) == "the monitor is for other requirements"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("return min(ticks, default=-1)", "return max(ticks, default=-1)"),
        ("import argparse\n", "import argparse\nimport random\n"),
        ("import argparse\n", "import argparse\nclass int(int): ...\n"),
        ("Truth = Optional[bool]\n", "Truth = Optional[bool]\nsince = None\n"),
        ("\n# The requirements ---", "from random import random\n# The requirements ---"),
    ],
)
def test_another_run_time_is_not_checked(old: str, new: str) -> None:
    text = emitted(WITHIN)
    assert old in text
    text = text.replace(old, new, 1)
    assert reason(check(WITHIN, text)).startswith((RUNTIME, LAYOUT))


def test_a_run_time_in_a_string_is_none() -> None:
    """What is executed is another one, where every verdict is pending."""
    text = emitted(WITHIN)
    place = text.index("# The requirements ---")
    other = text[:place].replace(
        "Verdict.SATISFIED, Verdict.VIOLATED, Ver", "Verdict.SATISFIED, Verdict.PENDING, Ver"
    )
    hidden = f"_ = r'''{kernel().text}'''\n"
    text = f"{other}{hidden}{text[place:]}"
    assert run(text, [P, NONE, NONE, NONE]) == "pending"
    assert reason(check(WITHIN, text)) == RUNTIME


# Hidden state ---------------------------------------------------------------------------------

LOOP = "            tick += 1\n"
BREACH = "            if r1_broken < 0 and since_1:\n"
SINCE = "            since_1 = oldest_1 >= 3\n"
INIT = "        self.tick = -1\n"
APPROXIMATION = "class R1Approximation"
CLASS = '    CELLS: ClassVar["tuple[str, ...]"] = (\n'
STEP = "        approximation.tick = tick = approximation.tick + 1\n"
SIGNALS = "    def signals(self)"
MONITOR = 'MONITOR: "type[Monitor]" = R1Monitor\n'
UNKNOWN = "                    known = False\n                    p = is_possible\n"

Edits = list[tuple[str, str]]


def logic(*lines: str) -> str:
    """Lines of the logic of a tick."""
    return "".join(f"            {line}\n" for line in lines)


def then(place: str, *lines: str) -> Edits:
    """Lines of the logic after a line."""
    return [(place, place + logic(*lines))]


def instead(line: str) -> Edits:
    """Another line in the place of the one that says when a demand is overdue."""
    return [(SINCE, logic(line))]


def before(place: str, text: str) -> Edits:
    return [(place, text + place)]


HIDDEN: dict[str, Edits] = {
    "the tick in a test of the logic": then(SINCE, "if tick == 5000: since_1 = True"),
    "the tick in a value": instead("since_1 = oldest_1 >= 3 or tick == 5000"),
    "the tick beside the violation": then(BREACH, "    r1_broken = tick", "if tick == 5000:"),
    "the tick within the violation": [
        (BREACH, logic("if r1_broken < 0 and (since_1 or tick == 5000):"))
    ],
    "the tick that a violation gives": [
        (
            f"{BREACH}                r1_broken = tick",
            f"{BREACH}                r1_broken = tick - 7000",
        )
    ],
    "a violation that is taken back": before(BREACH, logic("if p:", "    r1_broken = -1")),
    "a violation from the start": [
        ("        self.r1_broken = -1\n", "        self.r1_broken = 0\n")
    ],
    "a mark in the logic": instead("since_1 = oldest_1 >= 3 and r1_last < 5000"),
    "a signal in the logic": instead("since_1 = oldest_1 >= 3 and not self.r1_signals[0]"),
    "a mark that is no cell": then(SINCE, "r1_open = r1_open + 1"),
    "the tick through another name": then(LOOP, "now = tick"),
    "a local from row to row": [
        ("        known = True\n", "        known = True\n        kept = 0\n"),
        *then(SINCE, "kept = kept + 1"),
    ],
    "a local that some rows do not set": [
        *then(SINCE, "if p:", "    kept = q"),
        (BREACH, logic("if r1_broken < 0 and (since_1 or kept):")),
    ],
    "a cell that is not written back": [("        self.oldest_1 = oldest_1\n", "")],
    "a cell that is not read": [("        oldest_1 = self.oldest_1\n", "        oldest_1 = -1\n")],
    "a cell that is named as a mark": [(CLASS, CLASS + '        "r1_broken",\n')],
    "a slot that is no cell": [
        ('        "tick",\n', '        "tick",\n        "ticks",\n'),
        (INIT, INIT + "        self.ticks = 0\n"),
        *then(SINCE, "self.ticks = self.ticks + 1"),
    ],
    "an attribute of the class": then(SINCE, "R1Approximation.RUNS = 1"),
    "a list in the class": [
        *before(CLASS, "    SEEN: ClassVar[list[int]] = []\n"),
        *then(SINCE, "self.SEEN.append(1)"),
    ],
    "a global": [*before(APPROXIMATION, "SEEN = [0]\n\n\n"), *then(SINCE, "SEEN[0] += 1")],
    "a global statement": before(LOOP, logic("global R1Approximation")),
    "a default argument": [
        ('rows: "Iterable[Sequence[Any]]")', 'rows: "Iterable[Sequence[Any]]", seen: int = [])')
    ],
    "a function beside": before(
        APPROXIMATION, "def seen(counts=[0]):\n    counts[0] += 1\n    return counts[0] > 9\n\n\n"
    ),
    "a method beside": before(SIGNALS, "    def seen(self): return self.tick > 5000\n\n"),
    "a property": before(SIGNALS, "    @property\n    def seen(self): return self.tick > 5000\n\n"),
    "a closure": instead("since_1 = (lambda: oldest_1 >= 3 or tick > 5000)()"),
    "a name in an expression": instead("since_1 = (seen := oldest_1 >= 3)"),
    "a comprehension": instead("since_1 = [oldest_1 >= 3][0]"),
    "a call": instead("since_1 = bool(oldest_1 >= 3)"),
    "a change of the run time": before(
        APPROXIMATION, "Monitor.verdicts = lambda self: (PENDING,)\n\n\n"
    ),
    "another name of the run time": before(APPROXIMATION, "since = once\n\n\n"),
    "a change within a class": before(CLASS, "    sys.setrecursionlimit(5000)\n"),
    "a decorator": before("    def advance(", "    @copy.copy\n"),
    "another base": [("class R1Approximation:", "class R1Approximation(dict):")],
    "a metaclass": [("class R1Monitor(Monitor)", "class R1Monitor(Monitor, metaclass=type)")],
    "another class of the object": then(SINCE, "self.__class__ = R1Approximation"),
    "whether it is the same object": instead("since_1 = oldest_1 is q"),
    "True and 1 told apart": instead("since_1 = (oldest_1 >= 3) is not q"),
    "the approximation that may": instead("since_1 = oldest_1 >= 3 or is_possible"),
    "unknown values as they are not": [(UNKNOWN, UNKNOWN.replace("p = is_possible", "p = False"))],
    "an unknown value that is known": [(UNKNOWN, "                    p = is_possible\n")],
    "other rows": [("for (p, q) in rows", "for (q, p) in rows")],
    "no rows": [("        if tick == self.tick:\n            return True\n", "")],
    "a step of its own": before(
        STEP, "        if approximation.tick == 5000:\n            return VIOLATED\n"
    ),
    "a verdict of its own": [
        ("if approximation.r1_broken >= 0:", "if approximation.r1_broken > 0:")
    ],
    "a step of another approximation": [
        ("        approximation = self.certain\n", "        approximation = self.possible\n")
    ],
    "a step that takes what is unknown for false": [
        ("            or (q is not True and q is not False)\n", "")
    ],
    "a step that takes all for known": [("approximation is not self.possible\n", "False\n")],
    "a step in which nothing happens": [("            self._step((p, q))\n", "")],
    "other verdicts": [("if certain.r1_broken >= 0\n", "if certain.r1_broken > 5000\n")],
    "verdicts of another approximation": [
        ("        certain = self.certain\n", "        certain = self.possible\n")
    ],
    "a run of its own": [
        ("        self.advance(rows)\n", "        self.advance(list(rows)[:5000])\n")
    ],
    "a reset of its own": before("    def run(", "    def reset(self) -> None:\n        pass\n\n"),
    "another approximation": [
        (
            "    APPROXIMATION = R1Approximation\n",
            "    APPROXIMATION = type('R1Approximation', (R1Approximation,), {})\n",
        )
    ],
    "marks that are others": [("Marks(self.r1_broken,", "Marks(self.r1_open,")],
    "marks that are computed": [
        ("Marks(self.r1_broken,", "Marks(max(self.r1_broken, 5000 - self.tick),")
    ],
    "signals that are others": [("Signals(*self.r1_signals)", "Signals(*self.r1_signals[::-1])")],
    "a column program that counts": [
        ("trigger=p,", "trigger=p if every.bit_length() < 5000 else 0,")
    ],
    "a column program that keeps": [
        ("def columns(every: int, *,", "def columns(every: int, seen=[], *,")
    ],
    "another monitor": [(MONITOR, f"{MONITOR}R1Monitor.verdicts = 0\n")],
    "another name than the class": [
        (MONITOR, MONITOR.replace("R1Monitor", "type('X', (R1Monitor,), {})"))
    ],
    "more when it is run": [
        (
            "    sys.exit(main(MONITOR))",
            "    R1Approximation.CELLS = ()\n    sys.exit(main(MONITOR))",
        )
    ],
}


@pytest.mark.slow
@each("what", HIDDEN)
def test_what_may_hide_something_is_never_proved(what: str) -> None:
    text = edited(emitted(WITHIN), *HIDDEN[what])
    why = reason(check(WITHIN, text))
    assert why.startswith((LAYOUT, "what it does at a tick depends on")), why


WINDOWED = "only in m mode whenever p the sw shall after 2 ticks satisfy q"
WINDOW = "            since_1 = kept_since_1.step("


@pytest.mark.slow
@each(
    "edit",
    [
        (WINDOW, f"            kept_since_1.now = 0\n{WINDOW}"),
        (WINDOW, f"            kept_since_1 = kept_since_1\n{WINDOW}"),
        (WINDOW, "            since_1 = kept_since_1.now > 5000 or kept_since_1.step("),
        (WINDOW, "            since_1 = kept_since_1 or kept_since_1.step("),
        (WINDOW, "            since_1 = Window(1, 2).step("),
        ("self.r1_signals = (not_m", "self.r1_signals = (kept_since_1 and not_m"),
        ("= Window(2, 2)", "= Window(2, self.tick)"),
    ],
)
def test_a_window_is_stepped_and_nothing_else(edit: tuple[str, str]) -> None:
    why = reason(check(WINDOWED, edited(emitted(WINDOWED), edit)))
    assert why.startswith((LAYOUT, "what it does at a tick depends on")), why


def test_a_window_that_is_stepped_is_proved() -> None:
    assert check(WINDOWED).result is ClaimResult.PROVED


def test_the_reason_shows_the_place() -> None:
    text = edited(emitted(WITHIN), *HIDDEN["the tick in a value"])
    assert reason(check(WITHIN, text)) == "what it does at a tick depends on `tick`"
    text = edited(emitted(WITHIN), *HIDDEN["a global"])
    assert reason(check(WITHIN, text)) == f"{LAYOUT}: two classes and no more"
    text = edited(emitted(WITHIN), *HIDDEN["a call"])
    assert reason(check(WITHIN, text)) == f"{LAYOUT}: `bool(oldest_1 >= 3)`"


def run(text: str, rows: Sequence[tuple[bool, bool]]) -> str:
    machine: Monitor = load("monitor.py", text)
    for row in rows:
        machine.advance([row])
    return machine.verdicts()[0]


@pytest.mark.parametrize("what", ["the tick in a value", "the tick within the violation"])
def test_a_time_bomb_goes_off_where_it_is_not_looked_at(what: str) -> None:
    """So the layout has to be looked at: a few thousand steps show nothing."""
    text = edited(emitted(WITHIN), *HIDDEN[what])
    quiet = [(False, False)] * 5000
    assert run(text, quiet) == "pending"
    assert run(text, [*quiet, (False, False)]) == "violated"
    assert run(emitted(WITHIN), [*quiet, (False, False)]) == "pending"


# No monitor -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", "defines no"),
        ("", "defines no"),
        ("def f(:\n", "not valid Python"),
        ("raise SystemExit(0)\n", "defines no"),
        ("import nothing_of_that_name\n", "defines no"),
        ("MONITOR = 3\n", "defines no"),
        ("x = '\0'\n", "not valid Python"),
    ],
)
def test_what_is_no_monitor_is_told(text: str, message: str) -> None:
    with pytest.raises(NotAMonitorError, match=message):
        check(WITHIN, text)


def test_nothing_of_another_text_is_executed() -> None:
    text = "import os\nMONITOR: type = int\nos._exit(0)\n"
    assert reason(check(WITHIN, text)) == RUNTIME
    assert reason(check(WITHIN, emitted(WITHIN) + "import os\nos._exit(0)\n")) != RUNTIME


def cut(text: str) -> str:
    return text[: text.index("    def signals")]


def test_half_a_monitor_is_none() -> None:
    with pytest.raises(NotAMonitorError):
        check(WITHIN, cut(emitted(WITHIN)))


def test_another_deadline_in_its_words_is_not_proved() -> None:
    text = emitted(WITHIN).replace("            3,\n        ),", "            300,\n        ),")
    assert text != emitted(WITHIN)
    assert "states another sentence" in reason(check(WITHIN, text))


@pytest.mark.parametrize("bounds", ["60, 3", "-1, 3", "3, -1", "3, 2"])
def test_a_window_whose_state_is_less_than_what_it_goes_by_is_not_proved(bounds: str) -> None:
    """Ages above its end are one state, and it would ask for more of them."""
    changed = edited(
        emitted(WITHIN),
        ('        "is_possible",\n', '        "is_possible",\n        "w_1",\n'),
        ('        "oldest_1",\n    )', '        "oldest_1",\n        "w_1",\n    )'),
        ("self.oldest_1 = -1\n", f"self.oldest_1 = -1\n        self.w_1 = Window({bounds})\n"),
        ("= self.oldest_1\n", "= self.oldest_1\n        w_1 = self.w_1\n"),
        ("self.oldest_1 = oldest_1\n", "self.oldest_1 = oldest_1\n        self.w_1 = w_1\n"),
        (
            "if oldest_1 >= 0 and not_q",
            "far = w_1.step(True, p)\n            if oldest_1 >= 0 and not_q",
        ),
        ("elif p and not_q:", "elif p and not_q and not far:"),
    )
    assert reason(check(WITHIN, changed)).startswith(LAYOUT)
