"""Labels of a run: from its metadata, its path and the command; an untrusted texts stay texts."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.labels import given as given_labels
from fretc.logs.labels import labels, with_overrides
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations, LabelSource
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from tests.fretc.logs.logs import NONE, TWELVE, X_TEXT, ZSTD, declare, write
from tests.fretc.logs.storage.test_folders import PARTS, describe

VERSION = '[run.label]\nversion = "metadata:build.version"\n'
BUILD = [("build", {"version": "2.1", "secret": "never read"}), ("other", {"version": "9"})]
WAYS: list[dict[str, Any]] = [
    {"compression": ZSTD, "per_chunk": 3},
    {"compression": NONE, "data_crcs": True},
    {"chunked": False},
    {"crcs": False},
]


def described(path: Path, text: str, integrity: Integrity = Integrity.HASH) -> dict[str, Any]:
    declared = declare(X_TEXT + text)
    recording = read(str(path), declared, ["x"], integrity)
    assert isinstance(recording, Recording), recording
    return dict(recording.described)


@pytest.mark.parametrize("integrity", Integrity)
@pytest.mark.parametrize("way", WAYS)
def test_metadata_is_read_however_a_log_is_read(
    tmp_path: Path, integrity: Integrity, way: dict[str, Any]
) -> None:
    path = write(tmp_path / "a.mcap", TWELVE, metadata=BUILD, **way)
    assert described(path, VERSION, integrity) == {"build.version": ("2.1",)}
    assert described(path, "", integrity) == {}


def test_what_no_label_asks_for_is_not_even_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = [("build", {"version": "x" * 100_000})]
    path = write(tmp_path / "a.mcap", TWELVE, metadata=record, per_chunk=3)
    taken: list[int] = []
    whole = io.BufferedReader.read

    def counting(stream: io.BufferedReader, size: int | None = -1, /) -> bytes:
        data = whole(stream, size)
        taken.append(len(data))
        return data

    class Counting(io.BufferedReader):
        read = counting

    from fretc.logs.mcap.container import summary
    from fretc.logs.mcap.index import indexed

    for wanted, most in (((), 10_000), (("build.version",), 200_000)):
        taken.clear()
        with Counting(io.FileIO(path)) as stream:
            ends = summary(stream, path.stat().st_size)
            taken.clear()
            index = indexed(stream, path.stat().st_size, ends, wanted)
        assert index is not None
        assert (len(index.described) == 1) == bool(wanted)
        assert sum(taken) < most
        assert (sum(taken) > 100_000) == bool(wanted)


def test_metadata_changes_nothing_else_of_a_recording(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", TWELVE, metadata=BUILD, per_chunk=3)
    one, other = (read(str(path), declare(X_TEXT + t), ["x"]) for t in ("", VERSION))
    assert isinstance(one, Recording)
    assert isinstance(other, Recording)
    assert (one.checked, one.sha256, one.findings) == (other.checked, other.sha256, other.findings)


@pytest.mark.parametrize("parts", [PARTS, [TWELVE]])
def test_custom_data_of_a_bag_s_folder_counts(tmp_path: Path, parts: Any) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    for i, part in enumerate(parts):
        write(folder / f"run_{i}.mcap", part)
    describe(folder, parts, custom_data={"robot": "r7", "list": ["x"]})
    text = '[run.label]\nrobot = "metadata:custom_data.robot"\nlist = "metadata:custom_data.list"\n'
    path = folder if len(parts) > 1 else folder / "run_0.mcap"
    assert described(path, text) == {"custom_data.robot": ("r7",)}


@pytest.mark.slow
def test_a_hostile_record_gives_no_label_and_costs_no_verdict(tmp_path: Path) -> None:
    large = [("build", {"version": "x" * (2**20 + 1)})]
    path = write(tmp_path / "a.mcap", TWELVE, metadata=large, per_chunk=3)
    assert described(path, VERSION) == {}
    many = [("build", {"version": str(i)}) for i in range(3000)]
    path = write(tmp_path / "b.mcap", TWELVE, metadata=many)
    for integrity in Integrity:
        assert described(path, VERSION, integrity) == {"build.version": ("0", "1", "2", "3")}


# From what is described to labels


def sources(*texts: str) -> tuple[LabelSource, ...]:
    return tuple(LabelSource(not t.startswith("m:"), t.removeprefix("m:")) for t in texts)


def told(diagnostics: tuple[Diagnostic, ...]) -> list[str]:
    return [each.code.number for each in diagnostics]


def test_the_first_source_that_says_something_counts_and_another_is_a_conflict() -> None:
    declared = {"seed": sources("m:sim.seed", "{scenario}-{seed}.mcap")}
    found, said = labels(declared, "x/door-3.mcap", {"sim.seed": ("3",)})
    assert (found, said) == ({"seed": "3"}, ())
    found, said = labels(declared, "x/door-4.mcap", {"sim.seed": ("3",)})
    assert (found, told(said)) == ({"seed": "3"}, ["F552"])
    found, said = labels(declared, "x/door-4.mcap")
    assert (found, said) == ({"seed": "4"}, ())
    found, said = labels(declared, "x/door.mcap")
    assert (found, told(said)) == ({}, ["F553"])


@pytest.mark.parametrize("value", ["", "x" * 201, "x" * 10**6])
def test_a_value_that_is_no_label_is_none_and_never_half_of_one(value: str) -> None:
    found, (said,) = labels({"v": sources("m:a.v")}, "a.mcap", {"a.v": (value,)})
    assert found == {}
    assert said.code.number == "F553"
    assert len(render(said)) < 1000


def test_what_many_logs_lack_or_say_twice_is_one_warning() -> None:
    declared = {"v": sources("m:a.v"), "seed": sources("m:a.seed")}
    lacking = {told for i in range(9) for told in labels(declared, f"{i}.mcap")[1]}
    assert len(lacking) == 2
    clashes = (
        labels({"v": sources("m:a.v")}, f"{i}.mcap", {"a.v": (str(i), "x")})[1] for i in range(9)
    )
    assert len({one for some in clashes for one in some}) == 1


def test_markup_and_control_characters_are_kept_as_they_are() -> None:
    hostile = "\x1b[2J<script>\u202e"
    found, _ = labels({"v": sources("m:a.v")}, "a.mcap", {"a.v": (hostile, "other")})
    assert found == {"v": hostile}


def test_the_command_counts_before_all_and_says_so() -> None:
    found, said = with_overrides({"version": "1", "seed": "3"}, {"version": "2", "robot": "r"})
    assert found == {"version": "2", "seed": "3", "robot": "r"}
    assert told(said) == ["F552"]
    assert with_overrides({"version": "2"}, {"version": "2"})[1] == ()


@pytest.mark.parametrize("text", ["version", "=2", "1x=2", "a b=2", "v=", "v=" + "x" * 201])
def test_a_label_of_the_command_that_is_none_is_refused(text: str) -> None:
    refused = given_labels([text])
    assert isinstance(refused, Diagnostic)
    assert refused.code.number == "F551"


def test_labels_of_the_command_are_each_given_once() -> None:
    assert given_labels(["a=1", "b=x=y"]) == {"a": "1", "b": "x=y"}
    assert isinstance(given_labels(["a=1", "a=2"]), Diagnostic)
    assert isinstance(given_labels([f"l{i}=1" for i in range(33)]), Diagnostic)


# The bindings


def bound(text: str) -> tuple[Declarations | None, list[str]]:
    declared, said = read_bindings(Source("bindings.toml", X_TEXT + text))
    return declared, [render(each) for each in said]


def test_the_bindings_say_where_labels_come_from() -> None:
    declared, said = bound(
        '[run.label]\nversion = ["metadata:build.version", "path:v{version}/*"]\n'
    )
    assert not said
    assert declared is not None
    assert declared.labels == {"version": sources("m:build.version", "v{version}/*")}
    assert declared.restricted_to([]).labels == declared.labels


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ('version = "build.version"', "version"),
        ('version = "metadata:build"', "version"),
        ('version = "path:{name}.mcap"', "version"),
        ('version = "path:{version"', "version"),
        ("version = 3", "version"),
        ("version = []", "version"),
        ('"a b" = "path:{a}"', '"a b"'),
    ],
)
def test_a_source_that_is_none_is_refused_at_its_place(line: str, place: str) -> None:
    declared, (said,) = bound(f"[run.label]\n{line}\n")
    assert declared is not None
    assert declared.mistakes.keys() == {("run", "")}, "nothing that reads labels goes on"
    assert said.startswith("F551 ")
    number = X_TEXT.count("\n") + 2
    assert f"bindings.toml:{number}:" in said


def test_labels_are_no_part_of_what_a_verdict_rests_on() -> None:
    from fretish.bindings.canonical import bound as canonical
    from fretish.bindings.canonical import clock, digest

    declared = [declare(X_TEXT + text) for text in ("", VERSION)]
    one, other = (digest([clock(d.clock), canonical(d, ["low"])]) for d in declared)
    assert one == other


@given(st.dictionaries(st.sampled_from("abc"), st.text(max_size=250), max_size=3))
def test_whatever_a_log_says_labels_are_bounded(values: dict[str, str]) -> None:
    declared = {name: sources(f"m:r.{name}") for name in "abc"}
    found, _ = labels(declared, "a.mcap", {f"r.{k}": (v,) for k, v in values.items()})
    assert found == {k: v for k, v in values.items() if 0 < len(v) <= 200}
