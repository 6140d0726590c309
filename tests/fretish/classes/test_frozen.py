"""The classes are compared with those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import re
from collections.abc import Callable
from dataclasses import field
from pathlib import Path
from typing import Any

import pytest

from fretish.classes.frozen import dataclass

ROOT = Path(__file__).parents[3]
Decorator = Callable[..., Any]


def point(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class Point:
        """A place."""

        x: int
        names: tuple[str, ...] = ()
        tags: list[str] = field(default_factory=list)
        span: str | None = field(default=None, compare=False, repr=False)
        cache: dict[str, int] = field(default_factory=dict, init=False, compare=False)

    return Point


def single(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class Single:
        arg: object

    return Single


def empty(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class Empty:
        """Nothing."""

    return Empty


def own_methods(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class Own:
        number: int

        def __post_init__(self) -> None:
            assert self.number >= 0

        def __hash__(self) -> int:
            return 7

        def __repr__(self) -> str:
            return "own"

    return Own


def compared_by_hand(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class ByHand:
        number: int

        def __eq__(self, other: object) -> bool:
            return True

    return ByHand


def derived(make: Decorator) -> Any:
    @make(frozen=True, slots=True)
    class Derived(point(make)):  # type: ignore[misc]
        """A place with a height."""

        z: int = 3

    return Derived


@dataclass(frozen=True, slots=True)
class Sent:
    """At the top of a module, as pickle needs it."""

    number: int
    text: str = "a"


CASES: list[tuple[Callable[[Decorator], Any], list[tuple[Any, ...]]]] = [
    (point, [(1,), (1, ("a",)), (1, (), [], "here"), (2,)]),
    (single, [(1,), ("a",), ((1, 2),), (None,)]),
    (empty, [()]),
    (own_methods, [(0,), (1,)]),
    (compared_by_hand, [(0,), (1,)]),
    (derived, [(1,), (1, (), [], None, 4), (1, (), [], "here")]),
]


def test_values_are_equal_printed_and_hashed_as_those_of_the_standard_library() -> None:
    for make, arguments in CASES:
        ours, theirs = make(dataclass), make(dataclasses.dataclass)
        mine = [ours(*each) for each in arguments]
        expected = [theirs(*each) for each in arguments]
        assert [repr(each).split(".")[-1] for each in mine] == [
            repr(each).split(".")[-1] for each in expected
        ]
        assert [[a == b for b in mine] for a in mine] == [
            [a == b for b in expected] for a in expected
        ]
        assert [hash_or_error(each) for each in mine] == [hash_or_error(each) for each in expected]
        assert mine[0] != expected[0] or make is compared_by_hand
        assert ours.__match_args__ == theirs.__match_args__
        assert ours.__slots__ == theirs.__slots__
        assert [(f.name, f.type, f.default) for f in dataclasses.fields(ours)] == [
            (f.name, f.type, f.default) for f in dataclasses.fields(theirs)
        ]


def hash_or_error(value: object) -> int | str:
    try:
        return hash(value)
    except TypeError as error:
        return str(error)


def test_the_second_value_of_a_class_is_made_as_the_first() -> None:
    cls = point(dataclass)
    first, second = cls(1), cls(x=1, span="here")
    assert first == second
    assert first.tags is not second.tags
    assert first.cache is not second.cache
    assert (second.span, cls(2, tags=["a"]).tags) == ("here", ["a"])


def test_a_value_does_not_change() -> None:
    value = Sent(1)
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'number'"):
        value.number = 2  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'other'"):
        value.other = 2  # type: ignore[attr-defined]
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'number'"):
        del value.number
    assert value.number == 1


@pytest.mark.parametrize("arguments", [(), (1, "a", 2)])
def test_wrong_arguments_are_refused_in_the_words_of_the_standard_library(arguments: Any) -> None:
    theirs = dataclasses.make_dataclass(
        "Sent", [("number", int), ("text", str, "a")], frozen=True, slots=True
    )
    said = []
    for cls in (theirs, Sent):
        with pytest.raises(TypeError) as error:
            cls(*arguments)
        said.append(str(error.value))
    assert said[0] == said[1]


def test_the_tools_of_the_standard_library_work() -> None:
    value = Sent(1)
    assert dataclasses.replace(value, text="b") == Sent(1, "b")
    assert dataclasses.asdict(value) == {"number": 1, "text": "a"}
    assert dataclasses.is_dataclass(Sent)
    assert copy.copy(value) == copy.deepcopy(value) == pickle.loads(pickle.dumps(value)) == value
    match value:
        case Sent(number, "a"):
            assert number == 1
        case _:
            pytest.fail("no match")


def test_what_a_class_checks_is_checked_for_each_value() -> None:
    cls = own_methods(dataclass)
    for _ in range(2):
        with pytest.raises(AssertionError):
            cls(-1)


def test_other_options_are_those_of_the_standard_library() -> None:
    @dataclass(frozen=True, slots=True, order=True)
    class Ordered:
        number: int

    @dataclass
    class Changing:
        number: int

    assert Ordered(1) < Ordered(2)
    changing = Changing(1)
    changing.number = 2
    assert changing == Changing(2)


def test_all_rooms_above_take_their_classes_from_here() -> None:
    """One class of the standard library among them would also refuse ours as its base."""
    direct = re.compile(r"^from dataclasses import .*\bdataclass\b", re.MULTILINE)
    modules = [
        path for room in ("fretish", "compiler", "fretc") for path in (ROOT / room).rglob("*.py")
    ]
    assert not [path for path in modules if direct.search(path.read_text(encoding="utf-8"))]
