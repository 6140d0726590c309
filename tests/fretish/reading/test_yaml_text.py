"""YAML is read as it is written, and aliases that stand for far more are refused."""

import pytest

from fretish.reading.yaml_text import loaded


def doubled(kind: str, levels: int) -> str:
    """Each line stands for ten times what the line above it stands for."""
    return "a0: &a0 {x: 1}\n" + "".join(
        f"a{i}: &a{i} {kind.format(', '.join([f'*a{i - 1}'] * 10))}\n" for i in range(1, levels)
    )


def test_an_alias_is_what_its_anchor_holds() -> None:
    assert loaded("a: &x [1, 2]\nb: *x\nc: {<<: &y {d: 1}, e: *x}\n") == {
        "a": [1, 2],
        "b": [1, 2],
        "c": {"d": 1, "e": [1, 2]},
    }


@pytest.mark.parametrize("kind", ["[{}]", "{{<<: [{}]}}"])
def test_aliases_that_stand_for_a_billion_nodes_are_refused(kind: str) -> None:
    assert loaded(doubled(kind, 4))
    with pytest.raises(ValueError, match="too many nodes"):
        loaded(doubled(kind, 10))


@pytest.mark.parametrize("text", ["[" * 90_000, "{a: " * 90_000, "- " * 30_000])
def test_levels_without_end_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"not YAML|levels"):
        loaded(text)


BROKEN = ["a: 2026-99-99", "? [a]\n: 1", "a: [", "\0", "a: *b"]


@pytest.mark.parametrize("text", BROKEN)
def test_what_is_no_yaml_is_a_value_error(text: str) -> None:
    with pytest.raises(ValueError, match=r"YAML|month"):
        loaded(text)


@pytest.mark.slow
def test_a_long_text_without_aliases_is_read() -> None:
    assert len(loaded("\n".join(f"- {i}" for i in range(30_000)))) == 30_000


@pytest.mark.parametrize(
    "text", ["a: 1\na: 2", "a: 1\n'a': 2", "x: {a: 1, b: [a, a], a: {}}", "- a: {}\n  a: []"]
)
def test_a_key_that_comes_twice_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="`a` comes twice"):
        loaded(text)


def test_the_same_key_in_other_mappings_and_as_a_value_is_another() -> None:
    text = "a: {a: a}\nb: [{a: 1}, {a: 2}, a, a]\nc: a\n"
    assert loaded(text) == {"a": {"a": "a"}, "b": [{"a": 1}, {"a": 2}, "a", "a"], "c": "a"}
