"""What a command costs grows with an expression, not with the square of its depth or width."""

from collections.abc import Callable
from itertools import cycle, product
from pathlib import Path

import pytest

from tests.calls import calls
from tests.command import Fretc, runner, write
from tests.effort import FULL, needs_deep_calls, some

BINDINGS = """[clock]
tick = "100 ms"
[signal.x]
path    = "/odom.twist.twist.linear.x"
type    = "nav_msgs/Odometry"
unit    = "m/s"
max_age = "100 ms"
"""
SENTENCE = "whenever p the sw shall within 3 ticks satisfy "


def nested(template: str, levels: int) -> str:
    """The template within itself."""
    text = "p"
    for _ in range(levels):
        text = template.format(text)
    return text


def measured(levels: int) -> str:
    """A comparison with a sum of products in it."""
    return nested("x + 2 * ({})", levels).replace("p", "x") + " > 0"


SHAPES: dict[str, Callable[[int], str]] = {
    "and, or": lambda size: nested("q & (r | {})", size // 2),
    "xor": lambda size: nested("({}) xor q", size),
    "before": lambda size: nested("preBool(false, {})", size),
    "arithmetic": lambda size: measured(size // 2),
    "wide": lambda size: " & ".join(f"(p{i} | ! q{i})" for i in range(size)),
}


@pytest.fixture
def fretc(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Fretc:
    monkeypatch.chdir(tmp_path)
    write("requirements/bindings.toml", BINDINGS)
    return runner(monkeypatch, capsys)


COMMANDS = ("check", "explain", "json")
EACH_SHAPE_ONCE = [*zip(SHAPES, cycle(COMMANDS))]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "command"), [*product(SHAPES, COMMANDS)] if FULL else EACH_SHAPE_ONCE
)
def test_twice_the_size_costs_twice_as_much(fretc: Fretc, shape: str, command: str) -> None:
    options = {"check": ["check", "--requirements"], "json": ["--emit", "json"]}.get(
        command, [command]
    )

    def cost(size: int) -> int:
        write("requirements/r.fret", f'+++\nid = "R"\n+++\n{SENTENCE}{SHAPES[shape](size)}\n')
        return calls(lambda: fretc(*options, "requirements/r.fret"))

    cost(3)  # modules are imported, templates compiled
    least, small, large = cost(60), cost(100), cost(180)  # no monitor is made of any
    assert large - small < 2.5 * (small - least)


@needs_deep_calls
@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "shape"), some(product(["check", "explain"], ["and, or", "xor", "arithmetic"]), 4)
)
def test_a_deep_sentence_needs_no_more_room_than_there_is(
    fretc: Fretc, command: str, shape: str
) -> None:
    write("requirements/r.fret", f'+++\nid = "R"\n+++\n{SENTENCE}{SHAPES[shape](900)}\n')
    place = ["--requirements"] if command == "check" else []
    assert "F115" not in fretc(command, *place, "requirements/r.fret").err
