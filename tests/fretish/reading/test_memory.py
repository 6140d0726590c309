from dataclasses import dataclass

from fretish.reading import memory
from fretish.reading.memory import remembered


@dataclass(frozen=True)
class Thing:
    name: str


def test_a_value_is_computed_once_for_the_very_same_things() -> None:
    calls: list[tuple[Thing, int]] = []

    @remembered
    def value(thing: Thing, number: int) -> str:
        calls.append((thing, number))
        return thing.name

    one, equal = Thing("a"), Thing("a")
    assert [value(one, 1), value(one, 1), value(equal, 1), value(one, 2)] == ["a"] * 4
    assert len(calls) == 3


def test_things_that_are_gone_are_not_taken_for_others() -> None:
    @remembered
    def name(thing: Thing) -> str:
        return thing.name

    names = [name(Thing(str(i))) for i in range(2 * memory._MOST)]
    assert names == [str(i) for i in range(2 * memory._MOST)]
