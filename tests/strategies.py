"""What hypothesis draws: expressions, sentences, formulas, traces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from compiler.logic import formula as f
from fretish import expressions as e
from fretish import syntax as s
from tests import meaning
from tests.effort import FULL, pairwise

# Templates -----------------------------------------------------------------------------------

SCOPES = {
    "null": "",
    "in": "in m mode",
    "notin": "when not in m mode",
    "before": "before m mode",
    "after": "after m mode",
    "onlyIn": "only in m mode",
    "onlyBefore": "only before m mode",
    "onlyAfter": "only after m mode",
}
CONDITIONS = {"null": "", "regular": "upon p", "holding": "whenever p"}
TIMINGS = {
    "null": "",
    "immediately": "immediately",
    "next": "at the next timepoint",
    "finally": "finally",
    "eventually": "eventually",
    "always": "always",
    "never": "never",
    "within": "within {n} ticks",
    "for": "for {n} ticks",
    "after": "after {n} ticks",
    "until": "until s",
    "before": "before s",
}


@dataclass(frozen=True)
class Template:
    """One of the 288 templates of FRETish, with what its timing counts."""

    scope: str
    condition: str
    timing: str
    n: int

    @property
    def sentence(self) -> str:
        """The template as a sentence about m, p, q and s."""
        timing = TIMINGS[self.timing].format(n=self.n)
        return f"{SCOPES[self.scope]} {CONDITIONS[self.condition]} sw shall {timing} satisfy q"

    @property
    def columns(self) -> tuple[str, ...]:
        """The variables that it names."""
        used = {
            "m": self.scope != "null",
            "p": self.condition != "null",
            "q": True,
            "s": self.timing in ("until", "before"),
        }
        return tuple(name for name, named in used.items() if named)

    def satisfied(self, columns: Mapping[str, Sequence[bool]]) -> bool:
        """The meaning of the template, from its definition."""
        m, p, q, s = (columns.get(name, columns["q"]) for name in "mpqs")
        return meaning.satisfied(self.scope, self.condition, self.timing, self.n, m, p, q, s)


COUNTS = (0, 1, 2, 3) if FULL else (0, 2)


def templates(counts: tuple[int, ...] = COUNTS) -> Iterator[Template]:
    """Every template, those that count with each of the counts."""
    for scope in meaning.SCOPES:
        for condition in meaning.CONDITIONS:
            for timing in meaning.TIMINGS:
                for n in counts if timing in meaning.COUNTING else (0,):
                    yield Template(scope, condition, timing, n)


def few_templates(counts: tuple[int, ...] = COUNTS) -> list[Template]:
    """Every template with the full profile; else each condition with each timing.

    Scopes and counts take turns: no timing has only scopes with `only`, or none of them.
    """
    if FULL:
        return [*templates(counts)]
    found = []
    for i, condition in enumerate(meaning.CONDITIONS):
        for j, timing in enumerate(meaning.TIMINGS):
            scope = meaning.SCOPES[(j + 3 * i) % len(meaning.SCOPES)]
            n = counts[(i + j) % len(counts)] if timing in meaning.COUNTING else 0
            found.append(Template(scope, condition, timing, n))
    return found


def some_templates(counts: tuple[int, ...] = COUNTS) -> list[Template]:
    """Templates with every two of a scope, a condition and a timing; all with the full profile."""
    timings = [(t, n) for t in meaning.TIMINGS for n in (counts if t in meaning.COUNTING else (0,))]
    chosen = {*pairwise(meaning.SCOPES, meaning.CONDITIONS, timings)}
    return [t for t in templates(counts) if (t.scope, t.condition, (t.timing, t.n)) in chosen]


# Sentences -----------------------------------------------------------------------------------

NAMES = ("p", "q", "r1", "speed", "arm.joint", "load%", "too_close", "two words", "a[3]", "Fault")
"""Names as users choose them; the last but one need quotes."""
QUOTED_TEXTS = (
    "stand still", "a & b", "G", "!x", "1", "p0", "_bounded_0_", "a = b", "(a)", "f(x)", "it's",
    "back\\slash", "tail\\", "*/ /* //", "--", "# {}", "{{ x }}", "<!-- </script>", "%s %d",
    "$(x)", "Grüße", "日本", "\u202e", "tab\there", "\x7f", "n\u0308", "x" * 300, "LAST", "true",
    "FTP", " ", "0x1",
)  # fmt: skip
"""What quotes may hold: operators, comments, templates, names of our own."""
quoted_texts = st.one_of(
    st.sampled_from(QUOTED_TEXTS),
    st.text(st.characters(codec="utf-8", exclude_characters='"\r\n'), min_size=1, max_size=20),
)
FORMULA_ATOMS = ("a", "b")

names = st.sampled_from(NAMES).map(e.Name)
numbers = st.sampled_from(["0", "3", "12", "0.5", "1.5e-3", "20.0"]).map(e.Number)


def _arithmetic(inner: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Expression]:
    operators: st.SearchStrategy[Any] = st.sampled_from(["+", "-", "*", "/", "mod", "^"])
    return st.one_of(
        st.builds(e.Arithmetic, operators, inner, inner),
        st.builds(e.Negation, inner),
        st.builds(lambda arg: e.Call("absReal", (arg,)), inner),
    )


arithmetic: st.SearchStrategy[e.Expression] = st.recursive(
    st.one_of(names, numbers), _arithmetic, max_leaves=5
)
_comparison_operators: st.SearchStrategy[Any] = st.sampled_from(["<", "<=", ">", ">=", "=", "!="])
comparisons = st.builds(e.Comparison, _comparison_operators, arithmetic, arithmetic)
truths = st.booleans().map(e.Truth)


def _boolean(inner: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Expression]:
    return st.one_of(
        st.builds(e.Not, inner),
        st.builds(e.both, inner, inner),
        st.builds(e.either, inner, inner),
        st.builds(e.Xor, inner, inner),
        st.builds(e.Implies, inner, inner),
        st.builds(e.Iff, inner, inner),
        st.builds(lambda a, b: e.Call("f", (a, b)), inner, arithmetic),
        st.builds(lambda a, b: e.Call("prevOcc", (a, b)), inner, inner),
    )


expressions: st.SearchStrategy[e.Expression] = st.recursive(
    st.one_of(names, truths, comparisons), _boolean, max_leaves=6
)

scopes = st.one_of(st.none(), st.builds(s.Scope, st.sampled_from(s.ScopeKind), expressions))
conditions = st.one_of(
    st.none(), st.builds(s.Condition, st.sampled_from(s.ConditionKind), expressions)
)
_units: st.SearchStrategy[Any] = st.sampled_from(
    ["tick", "microsecond", "millisecond", "second", "minute", "hour"]
)
durations = st.builds(s.Duration, st.sampled_from([0, 1, 2, 3, 250, 10**6]), _units)
timings = st.one_of(
    st.just(s.Immediately()),
    st.just(s.Next()),
    st.just(s.Finally()),
    st.builds(s.Eventually, st.booleans()),
    st.just(s.Always()),
    st.just(s.Never()),
    st.builds(s.Within, durations),
    st.builds(s.For, durations),
    st.builds(s.After, durations),
    st.builds(s.Until, expressions),
    st.builds(s.Before, expressions),
)


def _probability(operator: Any, digits: str) -> s.Probability:
    return s.Probability(operator, Fraction(digits), digits)


probabilities = st.one_of(
    st.none(),
    st.builds(
        _probability, st.sampled_from(["<=", ">=", "=", "!="]), st.sampled_from(["0", "0.95", "1"])
    ),
)
sentences = st.builds(
    s.Sentence,
    scope=scopes,
    condition=conditions,
    component=st.sampled_from(["sw", "agilex_agent", "Rover 1", "T", "arm.joint"]),
    probability=probabilities,
    timing=timings,
    response=expressions,
)

# Formulas ------------------------------------------------------------------------------------


intervals = st.one_of(
    st.just(f.EVER),
    st.builds(f.Interval, st.integers(0, 2), st.none()),
    st.builds(lambda lo, more: f.Interval(lo, lo + more), st.integers(0, 3), st.integers(0, 2)),
)
leaves: st.SearchStrategy[f.Formula] = st.one_of(
    st.sampled_from([f.Atom(name) for name in FORMULA_ATOMS]), st.sampled_from([f.TRUE, f.FALSE])
)


def logic(inner: st.SearchStrategy[f.Formula]) -> list[st.SearchStrategy[f.Formula]]:
    several = st.lists(inner, min_size=2, max_size=3).map(tuple)
    return [
        st.builds(f.Not, inner),
        st.builds(f.And, several),
        st.builds(f.Or, several),
        st.builds(f.Xor, inner, inner),
        st.builds(f.Implies, inner, inner),
        st.builds(f.Iff, inner, inner),
    ]


Inner = st.SearchStrategy[f.Formula]
Intervals = st.SearchStrategy[f.Interval]


def past(inner: Inner, ago: Intervals = intervals) -> Inner:
    """One operator of the past, or of logic."""
    return st.one_of(
        *logic(inner),
        st.builds(f.Previous, inner),
        st.builds(f.WeakPrevious, inner),
        st.builds(f.Once, inner, ago),
        st.builds(f.Historically, inner, ago),
        st.builds(f.Since, inner, inner, ago),
    )


def future(inner: Inner, ahead: Intervals = intervals) -> Inner:
    """One operator of the future, or of logic."""
    return st.one_of(
        *logic(inner),
        st.builds(f.Next, inner),
        st.builds(f.Eventually, inner, ahead),
        st.builds(f.Globally, inner, ahead),
        st.builds(f.Until, inner, inner),
        st.builds(f.Release, inner, inner),
    )


past_formulas: st.SearchStrategy[f.Formula] = st.recursive(leaves, past, max_leaves=6)
"""Nodes as they are: no constructor has folded anything."""
future_formulas: st.SearchStrategy[f.Formula] = st.recursive(leaves, future, max_leaves=6)
logic_formulas: st.SearchStrategy[f.Formula] = st.recursive(
    leaves, lambda inner: st.one_of(*logic(inner)), max_leaves=6
)

# Traces --------------------------------------------------------------------------------------


def traces(*columns: str, max_size: int = 8) -> st.SearchStrategy[list[dict[str, bool]]]:
    """Rows of truth values; the shortest trace has one row."""
    row = st.fixed_dictionaries({name: st.booleans() for name in columns})
    return st.lists(row, min_size=1, max_size=max_size)


def three_valued(
    *columns: str, max_size: int = 8
) -> st.SearchStrategy[list[dict[str, bool | None]]]:
    """Rows of true, false and unknown."""
    value = st.sampled_from([False, True, None])
    row = st.fixed_dictionaries(dict.fromkeys(columns, value))
    return st.lists(row, min_size=1, max_size=max_size)
