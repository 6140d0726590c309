"""No command ends in a fault of fretc itself (F999), whatever the project and the option."""

import re
import shutil
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from tests.command import Fretc
from tests.command_lines import command_lines
from tests.drawn_projects import drawn
from tests.effort import FULL
from tests.fuzzing import sentences
from tests.keys import written

ROOT = Path(__file__).parents[2]
TRACE = ROOT / "traces/mission-seed15.mcap"
BEGINNING = 3 * 10**9
"""So many nanoseconds of it are read; all with the full profile."""
EXPORT = """{"requirements": [{"reqid": "R1", "project": "P", "fulltext": "the sw shall satisfy p"},
 {"reqid": "R 2", "project": "Q", "fulltext": "when p the sw shall always satisfy x > 3"}],
 "variables": [{"project": "P", "component_name": "sw", "variable_name": "p", "dataType": "boolean",
  "idType": "Input"}]}"""


@cache
def beginning() -> bytes:
    """The first messages of the trace."""
    if FULL:
        return TRACE.read_bytes()
    made, numbers = BytesIO(), dict[int, int]()
    with TRACE.open("rb") as stream:
        reader = make_reader(stream)
        writer: Any = Writer(made)
        writer.start(reader.get_header().profile)
        begun = None
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            begun = begun or message.log_time
            if message.log_time > begun + BEGINNING:
                break
            if channel.id not in numbers:
                type_ = writer.register_schema(schema.name, schema.encoding, schema.data)
                numbers[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, type_
                )
            writer.add_message(
                numbers[channel.id], message.log_time, message.data, message.publish_time
            )
        writer.finish()
    return made.getvalue()


def shipped(folder: str) -> Callable[[Fretc], None]:
    def write(fretc: Fretc) -> None:
        shutil.copytree(
            ROOT / folder, "requirements", ignore=lambda _, names: {*names} & {"agv", "mission"}
        )
        Path("l.mcap").write_bytes(beginning())

    return write


def begun(fretc: Fretc) -> None:
    """What `fretc init` makes of a log: its sentence compares signals directly."""
    Path("l.mcap").write_bytes(beginning())
    fretc("init", "new", "--from", "l.mcap")
    shutil.move("new/requirements", "requirements")
    shutil.rmtree("new")


def imported(fretc: Fretc) -> None:
    Path("export.json").write_text(EXPORT)
    fretc("import", "export.json", "-o", "requirements")
    Path("l.mcap").write_bytes(beginning())


def grown(fretc: Fretc) -> None:
    """Sentences of FRET's own tables, and what grows of them; some are none."""
    Path("requirements").mkdir()
    for number, sentence in enumerate(sentences(8, 1), 1):
        Path(f"requirements/r{number}.fret").write_text(sentence)
    shutil.copy(ROOT / "requirements/bindings.toml", "requirements/bindings.toml")
    Path("l.mcap").write_bytes(beginning())


def at_random(seed: int) -> Callable[[Fretc], None]:
    return lambda _: drawn(seed, Path())


PROJECTS: dict[str, Callable[[Fretc], None]] = {
    "shipped": shipped("requirements"),
    "agv": shipped("requirements/agv"),
    "mission": shipped("requirements/mission"),
    "init": begun,
    "import": imported,
    "FRET": grown,
    **{f"drawn {seed}": at_random(seed) for seed in range(200 if FULL else 5)},
}
LINES = command_lines()
LARGE = ("shipped", "agv", "mission", "FRET")
SMALL = [place for place, name in enumerate(PROJECTS) if name not in LARGE]
COSTLY = {"analyze": 3, "test": 5, "verify": 5, "verify-evidence": 3, "mutate": 3, "check": 3,
          "audit": 2, "watch": 1, "sbom": 2}  # fmt: skip
"""Searches, proofs, and what reads the whole log: without the full profile one in so many of these
lines is tried, and with small projects alone."""


def places(number: int, line: tuple[str, ...]) -> list[int]:
    """The projects that a line is tried with: all with the full profile, else one at most."""
    if FULL:
        return [*range(len(PROJECTS))]
    step = COSTLY.get(line[0])
    if step is None:
        return [number // 2 % len(PROJECTS)] if number % 2 == 0 else []
    return [SMALL[number // step % len(SMALL)]] if number % step == 0 else []


def prepared(fretc: Fretc, write: Callable[[Fretc], None]) -> dict[str, str]:
    """The project in the current folder, what other commands read of it, and its own names."""
    write(fretc)
    written("key")
    if not Path("export.json").exists():
        Path("export.json").write_text(EXPORT)
    Path("logs.sha256").write_text(f"{sha256(Path('l.mcap').read_bytes()).hexdigest()}  l.mcap\n")
    fretc("audit", "l.mcap", "--jobs", "1", "-o", "build/evidence.json")
    fretc("requirements", "--emit", "monitor")
    ids = [line[6:-1] for path in sorted(Path("requirements").glob("*.fret"))
           for line in path.read_text().splitlines() if line.startswith('id = "')]  # fmt: skip
    id = ids[0] if ids else sorted(Path("requirements").glob("*.fret"))[0].stem
    return {"id": id, "stem": id.lower(), "component": "sw"}


def _filled(word: str, names: dict[str, str]) -> str:
    """The word with the project's names; other braces are the command's own."""
    return re.sub(r"{(id|stem|component)}", lambda found: names[found[1]], word)


@pytest.mark.slow
@pytest.mark.parametrize("place", range(len(PROJECTS)), ids=[*PROJECTS])
def test_no_command_is_at_fault(fretc: Fretc, place: int) -> None:
    """Each line with a project, and with all of them with the full profile."""
    names = prepared(fretc, [*PROJECTS.values()][place])
    for number, line in enumerate(LINES):
        if place in places(number, line):
            words = [_filled(word, names) for word in line]
            try:
                run = fretc(*words)
            except BaseException as error:
                error.add_note(f"fretc {' '.join(words)}")
                raise
            assert run.status in (0, 1, 2, 3), words
            assert run.err.count(" accepted: `fretc check`") <= 1, words
