"""Every command, with each choice of each option, where fretc has only what it always needs.

    python tests/plain_installation.py CHECKOUT [SETTING.json]

Where fretc is installed without extras it needs nothing else. SETTING.json hides `packages` and
`distributions`, as if they were not installed, and names what is `left_out` of the lines. It prints
an object of JSON for each line: its words, status, both outputs, and the SHA-256 of each file that
is new or changed. Exit status 1: a line ends by F999; or no message names the extra of a package.
"""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

LOG = "traces/mission-seed15.mcap"
RULE = "requirements/r1.fret"
SMALL = ("--requirements", "small/always.fret")
LINES: tuple[tuple[str, ...], ...] = (
    ("compile", RULE, "-o", "build"),
    ("init", "made"),
    ("fmt", RULE),
    ("import", "fret.json"),
    ("write", "when a the robot must stop", "-o", "build/w.fret", "--choose", "1"),
    ("explain", "R1"),
    ("info", LOG),
    ("bind", "--from", LOG),
    ("check",),
    ("play", "requirements"),
    ("analyze", "small/game.fret", "-o", "analysis.json"),
    ("test", RULE, "--emit-to", "build/tests"),
    ("audit", LOG),
    ("audit", "traces", "-o", "build/evidence"),
    ("audit", LOG, "--parquet", "build/t.parquet"),
    ("audit", "--query", "select verdict from results", "build/evidence"),
    ("audit", LOG, "--annotate"),
    ("coverage", "traces", "--jobs", "1"),
    ("mutate", RULE, "--against", LOG),
    ("report",),
    ("trends", "build/evidence.json"),
    ("lock", "--reviewer", "A", "--role", "r", "--comment", "c"),
    ("diff",),
    ("verify", RULE, "--monitor"),
    ("verify-evidence", "--no-proofs"),
    ("watch", "json.mcap", *SMALL),
    ("simulate", "--list"),
    ("completion", "bash"),
    ("lsp",),
    ("sign", "build/evidence.json", "--key", "key"),
    ("lock", "--reviewer", "B", "--role", "r", "--comment", "c", "--key", "key"),
    ("verify-evidence", "--signed-by", "key"),
    ("sbom",),
    ("simulate", "nominal", "-o", "mission.mcap"),
    ("simulate", "--campaign", "1"),
    ("audit", LOG, "--engine", "dask"),
    ("audit", "run.bag"),
    ("audit", "http://127.0.0.1:9/run.mcap"),
    ("audit", "s3://bucket/runs/"),
    ("info", "run.bag"),
    ("init", "other", "--from", "run.bag"),
    ("bind", "--from", "run.bag"),
    ("bind", "--check", "run.bag"),
    ("coverage", "run.bag"),
    ("mutate", RULE, "--against", "run.bag"),
    ("watch", "dds"),
    ("watch", "foxglove", "ws://127.0.0.1:9"),
    ("watch", "zenoh", "tcp/127.0.0.1:9"),
    ("watch", "json.mcap", *SMALL, "--publish", "foxglove:0"),
    ("check", "--requirements", "parents"),
    ("audit", "protobuf.mcap", *SMALL),
    ("audit", "idl.mcap", *SMALL),
    ("audit", "flight.ulg", *SMALL),
    ("audit", "table.feather", *SMALL),
)
"""The first of a command is run with each choice of each of its options, too."""
LONGEST = 600
"""Seconds of a clock for a line: it hangs."""
BINDINGS = """
[clock]
tick = "100 ms"
[signal.v]
path = "/t.v"
unit = "1"
[proposition.p]
expr = "v > 1"
role = "input"
[variable.q]
role = "output"
"""


class Hiding:
    """A finder that does not find some packages and distributions."""

    def __init__(self, finder: Any, packages: set[str], distributions: set[str]) -> None:
        self._finder, self._packages, self._distributions = finder, packages, distributions

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        if name.partition(".")[0] in self._packages:
            return None
        return self._finder.find_spec(name, path, target)

    def find_distributions(self, *context: Any) -> Iterator[Any]:
        if hasattr(self._finder, "find_distributions"):
            for each in self._finder.find_distributions(*context):
                if re.sub(r"[-_.]+", "-", each.name).lower() not in self._distributions:
                    yield each

    def invalidate_caches(self) -> None:
        if hasattr(self._finder, "invalidate_caches"):
            self._finder.invalidate_caches()


def hide(packages: set[str], distributions: set[str]) -> None:
    """Hide them from all that is imported from now on."""
    for name in [name for name in sys.modules if name.partition(".")[0] in packages]:
        del sys.modules[name]
    sys.meta_path[:] = [Hiding(each, packages, distributions) for each in sys.meta_path]


def lines() -> Iterator[tuple[str, ...]]:
    """Each of the table, and behind the first of a command each choice of its options."""
    import click

    from fretc.cli import cli

    assert isinstance(cli, click.Group)
    missing = cli.commands.keys() - {words[0] for words in LINES}
    assert not missing, f"no line of {missing}"
    known = set[str]()
    for words in LINES:
        yield words
        if words[0] not in known:
            known.add(words[0])
            for option in cli.commands[words[0]].params:
                if isinstance(option, click.Option) and isinstance(option.type, click.Choice):
                    yield from ((*words, option.opts[-1], choice) for choice in option.type.choices)


def run(words: Sequence[str]) -> dict[str, Any]:
    """One line, in this process."""
    from fretc.cli import main

    outputs = [io.BytesIO(), io.BytesIO()]
    out, err = (io.TextIOWrapper(output, encoding="utf-8") for output in outputs)
    sys.argv = ["fretc", *(words[1:] if words[0] == "compile" else words)]
    sys.stdin = io.TextIOWrapper(io.BytesIO())
    status: object = 0
    before = hashes()
    signal.alarm(LONGEST)
    try:
        with redirect_stdout(out), redirect_stderr(err):
            main()
    except SystemExit as end:
        status = end.code or 0
    finally:
        signal.alarm(0)
    out.flush()
    err.flush()
    texts = [output.getvalue().decode() for output in outputs]
    files = dict(hashes().items() - before.items())
    return {"words": words, "status": status, "out": texts[0], "err": texts[1], "files": files}


def hashes() -> dict[str, str]:
    """The SHA-256 of each file below this folder."""
    return {
        str(path): sha256(path.read_bytes()).hexdigest()
        for path in Path().rglob("*")
        if path.is_file()
    }


def prepare(checkout: Path) -> None:
    """A project like that of the checkout, with logs that need extras."""
    from mcap.writer import Writer

    for name in ("requirements", "traces"):
        shutil.copytree(checkout / name, name)
    Path("run.bag").write_bytes(b"#ROSBAG V2.0\n")
    Path("flight.ulg").write_bytes(b"ULog\x01\x12\x35")
    Path("table.feather").write_bytes(b"ARROW1\0\0")
    Path("key").write_text("")
    Path("fret.json").write_text("[]")
    for name in ("parents", "small"):
        Path(name).mkdir()
        Path(name, "bindings.toml").write_text(BINDINGS)
        Path(name, "always.fret").write_text("the sw shall always satisfy p")
    Path("small/game.fret").write_text("whenever p the sw shall within 2 ticks satisfy q")
    Path("parents/fretc.toml").write_text('[tool.fretc]\nparents = ["p.reqif"]\n')
    Path("parents/p.reqif").write_text("<REQ-IF/>")
    idl = b"struct T { double v; };"
    for name, encoding, text, payload in (
        ("json", ("jsonschema", "json"), b'{"type": "object"}', b'{"v": 2}'),
        ("protobuf", ("protobuf", "protobuf"), b"", b""),
        ("idl", ("ros2idl", "cdr"), idl, bytes(12)),
    ):
        with Path(f"{name}.mcap").open("wb") as stream:
            writer: Any = Writer(stream)
            writer.start()
            schema = writer.register_schema("T", encoding[0], text)
            channel = writer.register_channel("/t", encoding[1], schema)
            for i in range(20):
                writer.add_message(channel, i * 10**8, payload, i * 10**8)
            writer.finish()


def is_bad(done: dict[str, Any]) -> bool:
    """Whether it is no answer, or one about a package without the extra that installs it."""
    unnamed = "No module named" in done["err"] and "fretc[" not in done["err"]
    return unnamed or "F999" in done["err"] or done["status"] not in (0, 1, 2, 3)


def main(checkout: Path, setting: str | None) -> int:
    """Run all lines in a folder of their own, and print them."""
    left_out: list[list[str]] = []
    if setting is not None:
        found = json.loads(Path(setting).read_text())
        left_out = found["left_out"]
        hide(set(found["packages"]), set(found["distributions"]))
    bad = 0
    with TemporaryDirectory() as folder:
        os.environ["XDG_STATE_HOME"] = folder
        os.environ["SOURCE_DATE_EPOCH"] = "1700000000"
        os.chdir(folder)
        os.mkdir("project")
        os.chdir("project")
        prepare(checkout)
        for words in lines():
            if [*words] not in left_out:
                done = run(words)
                print(json.dumps(done), flush=True)
                if is_bad(done):
                    print(*words, done["err"], sep="\n", file=sys.stderr)
                    bad = 1
    return bad


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else None))
