from dataclasses import dataclass

from fretish.reading import caching
from fretish.reading.caching import cache_by_identity


@dataclass(frozen=True)
class Thing:
    name: str


def test_a_value_is_computed_once_for_the_very_same_things() -> None:
    calls: list[tuple[Thing, int]] = []

    @cache_by_identity
    def value(thing: Thing, number: int) -> str:
        calls.append((thing, number))
        return thing.name

    one, equal = Thing("a"), Thing("a")
    assert [value(one, 1), value(one, 1), value(equal, 1), value(one, 2)] == ["a"] * 4
    assert len(calls) == 3


def test_things_that_are_gone_are_not_taken_for_others() -> None:
    @cache_by_identity
    def name(thing: Thing) -> str:
        return thing.name

    names = [name(Thing(str(i))) for i in range(2 * caching._MOST)]
    assert names == [str(i) for i in range(2 * caching._MOST)]
