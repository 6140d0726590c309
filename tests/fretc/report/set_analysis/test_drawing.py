"""The picture of a play: each column in its place, and the violation where it is."""

from typing import Any

from fretc.report.model.sets import Play, PlayLane
from fretc.report.set_analysis.drawing import drawing


def drawn(values: list[str], loop: int | None = None, *, breaks: bool = True) -> dict[str, Any]:
    lane = PlayLane("p", "input", tuple(values))
    ticks = tuple(map(str, range(len(values))))
    found = drawing(Play(ticks, (lane,), loop), "x", "A run", breaks=breaks)
    assert found is not None
    return found


def test_a_run_without_ticks_has_no_picture() -> None:
    assert drawing(Play((), (), None), "x", "A run", breaks=False) is None


def test_the_last_column_is_the_breach() -> None:
    found = drawn(["1", "0", "1"])
    assert found["last"] is not None
    begin, width = found["last"]
    assert begin < found["heads"][-1][0] < begin + width
    assert found["heads"][-2][0] < begin


def test_what_comes_again_is_marked() -> None:
    found = drawn(["1", "0", "1", "0"], loop=1)
    assert found["last"] is not None
    begin, width = found["last"]
    assert [begin < x < begin + width for x, _ in found["heads"]] == [False, True, True, True]


def test_a_run_that_breaks_nothing_has_no_mark() -> None:
    assert drawn(["1", "0"], breaks=False)["last"] is None


def test_a_long_play_keeps_its_ends() -> None:
    found = drawn(["1", "0"] * 200)
    heads = [head for _, head in found["heads"]]
    assert heads[0] == "0"
    assert heads[-1] == "399"
    assert found["gap"] is not None
    assert found["width"] < 2000


def test_numbers_are_texts() -> None:
    (lane,) = drawn(["1", "2.5"])["lanes"]
    assert lane["path"] == ""
    assert [text for _, text in lane["texts"]] == ["1", "2.5"]
