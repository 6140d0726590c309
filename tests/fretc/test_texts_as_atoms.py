"""Names and words in quotes may be any text: each command and each target works, or gives a coded
message that says what it cannot do."""

import json
import re
from collections.abc import Sequence

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.emit import TARGETS
from tests.command import Fretc, without_processes, write
from tests.effort import FULL, some
from tests.strategies import QUOTED_TEXTS, quoted_texts

COMMANDS = (
    *(("explain", f"requirements/{name}.fret") for name in ("word", "name0")),
    ("play", "requirements"),
    ("analyze",),
    ("test", "requirements/word.fret", "--time", "5"),
    ("verify", "requirements/word.fret", "requirements/name0.fret", "--monitor"),
    *(
        ("requirements", "--emit", "ltl", *more)
        for more in ([], ["--simplify"], ["--notation", "spot"], ["--notation", "latex"])
    ),
    *(("requirements", "--emit", kind) for kind in TARGETS if kind != "ltl"),
)
_CODED = re.compile(r"^F\d{3} ", re.MULTILINE)


def toml(text: str) -> str:
    """A string of TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def project(texts: Sequence[str]) -> None:
    """Sentences about words and about names of all of the texts.

    Names are two in a sentence: an agent may perceive any of them at once.
    """
    values = ", ".join(map(toml, ("dock", *texts)))
    write(
        "requirements/bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.mo]\npath = "/m.v"\ntype = "my_msgs/Mode"\n'
        f'role = "output"\nvalues = [{values}]\n',
    )
    words = " | ".join(f'mo = "{text}"' for text in texts)
    write("requirements/word.fret", f"whenever near the agv shall eventually satisfy {words}\n")
    named = [f'"{text}"' for text in texts]
    for first in range(0, len(named), 2):
        names = " | ".join(named[first : first + 2])
        sentence = f"whenever {names} the agv shall eventually satisfy done\n"
        write(f"requirements/name{first}.fret", sentence)
    write(
        "requirements/odds.fret",
        f"whenever {' | '.join(named)} the agv shall with probability >= 0.9 "
        f"eventually satisfy {words}\n",
    )


def check(fretc: Fretc, texts: Sequence[str]) -> None:
    """Each command says why where it fails."""
    project(texts)
    for command in COMMANDS:
        run = fretc(*command)
        assert run.status in (0, 1, 2, 3)
        if run.status == 2:
            assert _CODED.search(run.err), (command, run)


@pytest.mark.slow
@pytest.mark.parametrize("first", some(range(0, len(QUOTED_TEXTS), 4), 6, 2))
def test_every_command_takes_any_word_and_any_name(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, first: int
) -> None:
    without_processes(monkeypatch)
    check(fretc, QUOTED_TEXTS[first : first + 4])


@pytest.mark.slow
@settings(
    max_examples=200 if FULL else 1,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(texts=st.lists(quoted_texts, min_size=1, max_size=3, unique=True))
def test_every_command_takes_whatever_is_drawn(fretc: Fretc, texts: list[str]) -> None:
    check(fretc, texts)


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        (("analyze",), "F354 `mo` has no role"),
        (
            ("requirements", "--emit", "prism"),
            "F601 PRISM cannot express a requirement without a probability, such as that of a",
        ),
    ],
)
def test_what_ends_with_2_says_why(fretc: Fretc, command: tuple[str, ...], reason: str) -> None:
    write(
        "requirements/bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.mo]\npath = "/m.v"\nvalues = ["dock", "stand still"]\n',
    )
    write("requirements/a.fret", 'the agv shall always satisfy mo = "stand still"\n')
    run = fretc(*command)
    assert (run.status, run.err.startswith(reason)) == (2, True), run
