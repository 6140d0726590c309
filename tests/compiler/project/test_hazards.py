"""Where parents lead: to a hazard, to nothing, or in a circle."""

from collections.abc import Mapping
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from compiler.project.hazards import cycles, unknown_parents, without_hazard
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

NAMES = ("A", "B", "C", "D", "E")


def written(parents: Mapping[str, str]) -> list[RequirementEntry]:
    """Requirements by their ids, each with the letters of its parents."""
    place = Source("r.fret", "x").span()
    return [RequirementEntry(id, place, parents=tuple(above)) for id, above in parents.items()]


def messages(parents: Mapping[str, str]) -> list[str]:
    return [diagnostic.message for diagnostic in cycles(written(parents))]


def test_a_circle_is_shown_once_and_whole() -> None:
    assert messages({"A": "A"}) == ["A is its own ancestor: A → A"]
    assert messages({"A": "B", "B": "CH", "C": "A"}) == ["A is its own ancestor: A → B → C → A"]
    assert messages({"A": "B", "B": "B", "C": "DA", "D": "C"}) == [
        "B is its own ancestor: B → B",
        "C is its own ancestor: C → D → C",
    ]
    assert messages({"A": "BC", "B": "D", "C": "D", "D": "H"}) == []


graphs = st.fixed_dictionaries(
    {name: st.sets(st.sampled_from((*NAMES, "H")), max_size=2).map(sorted).map("".join)
     for name in NAMES}
)  # fmt: skip


def reach(parents: Mapping[str, str], start: str) -> set[str]:
    """Everything above, by as many rounds as there are names."""
    found = set(parents.get(start, ""))
    for _ in parents:
        found |= {above for id in found for above in parents.get(id, "")}
    return found


@given(graphs)
def test_each_requirement_in_a_circle_is_in_one_that_is_told_or_meets_one(
    parents: dict[str, str],
) -> None:
    own = {name for name in NAMES if name in reach(parents, name)}
    shown = [message.partition(": ")[2].split(" → ") for message in messages(parents)]
    assert bool(shown) == bool(own)
    for way in shown:
        assert way[0] == way[-1]
        assert set(way) <= own
        assert all(above in parents[id] for id, above in pairwise(way))
    for name in own:
        assert any({*way} & (reach(parents, name) | {name}) for way in shown)


@given(graphs)
def test_whoever_reaches_no_hazard_is_told(parents: dict[str, str]) -> None:
    found = {requirement.id for requirement in without_hazard(written(parents), {"H"})}
    assert found == {name for name in NAMES if parents[name] and "H" not in reach(parents, name)}


def test_a_hazard_that_only_a_retired_requirement_names_is_not_reached() -> None:
    (low, _) = written({"A": "B", "B": "H"})
    assert list(without_hazard([low], {"H"})) == [low]


def test_without_any_file_of_hazards_all_unknown_parents_are_one_message() -> None:
    requirements = written({"A": "H", "B": "HJ", "C": "A"})
    (one,) = unknown_parents(requirements, (), (), None)
    assert one.message == (
        "there is no `hazards.toml`: the parent `H` of A is declared nowhere (2 more parents "
        "are, too)"
    )
    assert len(list(unknown_parents(requirements, (), (), "hazards.toml"))) == 3
    assert list(unknown_parents(requirements, "HJ", (), "hazards.toml")) == []
