"""The adapter of a monitor that is stepped by variables: comparisons compute its propositions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import atom, variable
from compiler.logic.printing import is_compound
from compiler.targets.python.comparisons import (
    NUMBER,
    TRUTH,
    WORD,
    ComparisonWriter,
    CompiledComparison,
    NotCompiledError,
    StepInput,
)
from fretish import expressions as e
from fretish.bindings.comparisons import is_measured
from fretish.bindings.declarations import ComputedSignal, MeasuredSignal, Reading, Reduce
from fretish.checking import conditions
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class InputAdapter:
    """The adapter from the variables of a tick to the truth of propositions."""

    inputs: Mapping[str, StepInput]
    comparisons: Mapping[str, CompiledComparison]
    """The comparisons by the names of their propositions."""


@with_recursion_limit
def input_adapter(
    requirements: Sequence[FormalizedRequirement], propositions: Sequence[str]
) -> InputAdapter | None:
    """The adapter of a monitor: its variables and comparisons; None if nothing is compared.

    A variable that is a number in one place and a truth value in another stays a proposition, and
    so does a comparison that two requirements read in different units.

    Args:
        requirements: the requirements of one monitor.
        propositions: the propositions that the monitor reads.
    """
    comparisons: dict[str, CompiledComparison] = {}
    opaque: set[str] = set()
    for requirement in requirements:
        for name, compared in _comparisons(requirement).items():
            if comparisons.setdefault(name, compared) != compared:
                opaque.add(name)
    clashing = set(_clashing(requirements, comparisons.values()))
    usable = {
        name: compared
        for name, compared in comparisons.items()
        if name in propositions and name not in opaque and clashing.isdisjoint(compared.inputs)
    }
    if not usable:
        return None
    inputs: dict[str, StepInput] = {}
    for name in propositions:
        inputs |= usable[name].inputs if name in usable else {name: StepInput(TRUTH)}
    return InputAdapter(inputs, usable) if inputs else None


def _comparisons(requirement: FormalizedRequirement) -> dict[str, CompiledComparison]:
    """The comparisons of a sentence that can be compiled, by their propositions' names."""
    by_name: dict[str, CompiledComparison] = {}
    for tree in conditions(requirement.sentence):
        for part in e.parts(tree):
            if isinstance(part, e.Comparison):
                compared = _compared(part, requirement)
                if compared is not None:
                    by_name[atom(part)] = compared
    return by_name


def _clashing(
    requirements: Sequence[FormalizedRequirement], comparisons: Iterable[CompiledComparison]
) -> Iterator[str]:
    """The variables with two kinds, or two units."""
    kinds: dict[str, StepInput] = {
        name: StepInput(TRUTH)
        for requirement in requirements
        for name in requirement.propositions
        if not is_compound(name)
    }
    units: dict[str, object] = {}
    for compared in comparisons:
        for name, kind in compared.inputs.items():
            unit = compared.units.get(name)
            if kinds.setdefault(name, kind) != kind or units.setdefault(name, unit) != unit:
                yield name


def _compared(tree: e.Comparison, requirement: FormalizedRequirement) -> CompiledComparison | None:
    """The compiled comparison; None if it cannot be compiled.

    A comparison bound by its text is evaluated from the names in its binding; the names in the
    sentence are not inputs.
    """
    signals = requirement.declarations.measured if requirement.declarations else {}
    is_bound = requirement.declarations and atom(tree) in requirement.declarations.propositions
    if is_bound and not is_measured(tree, signals):
        return None
    names = tuple(dict.fromkeys(name.id for name in e.names(tree)))
    units = {
        variable(id): (signals[id].unit_name, signals[id].scale) for id in names if id in signals
    }
    spoken = _spoken(tree, signals)
    if spoken is not None:
        ids, words = spoken
        return CompiledComparison({variable(id): StepInput(WORD, words) for id in ids}, tree, units)
    numbers = {variable(id): StepInput(NUMBER, infinite=_infinite(signals.get(id))) for id in names}
    compared = CompiledComparison(numbers, tree, units)
    try:
        ComparisonWriter(dict.fromkeys(compared.inputs, "x")).comparison(compared)
    except NotCompiledError:
        return None
    return compared


def _infinite(signal: MeasuredSignal | None) -> tuple[str, ...]:
    """The infinities that a sample can be: far (`+inf`) and near (`-inf`)."""
    if signal is None:
        return ()
    if isinstance(signal, ComputedSignal):
        return ("+inf", "-inf")  # what is computed may be too large for a float
    invalid = signal.invalid
    meant = (invalid.nan, invalid.positive_infinity, invalid.negative_infinity, invalid.other)
    far, near = Reading.FAR in meant, Reading.NEAR in meant
    is_gap = signal.reduce is Reduce.OUTLINE  # of which the nearest is 0
    return ("+inf",) * far + ("-inf",) * (near and not is_gap)


def _spoken(
    tree: e.Comparison, signals: Mapping[str, MeasuredSignal]
) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """The enumerated signals of a comparison by `=` or `!=`, and its values."""
    match tree:
        case e.Comparison("=" | "!=", e.Name(id), e.Word()) | e.Comparison(
            "=" | "!=", e.Word(), e.Name(id)
        ) if id in signals:
            return (id,), signals[id].values
        case e.Comparison("=" | "!=", e.Name(id), e.Name(other)) if (
            id in signals and other in signals and signals[id].values
        ):
            return (id, other), signals[id].values
        case _:
            return None
