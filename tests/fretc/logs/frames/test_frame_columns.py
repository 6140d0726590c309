"""Signals of frames in recordings, in watches and in nodes: tf2's answers, and the same samples."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.watch.decoding import Decoder
from fretc.watch.sources.source import Arrival, Channel
from fretish.diagnostics.diagnostic import Code
from tests.effort import examples
from tests.fretc.logs.frames.robot import drive, transforms
from tests.fretc.logs.logs import MS, NONE, S, Sent, declare, definition, write
from tests.monitors.test_transforms import ANSWERS, transform

BINDINGS = """
[clock]
tick = "100 ms"

[signal.x]
frame = "laser"
in = "map"
path = "x"

[signal.heading]
frame = "base_link"
in = "/map"
path = "yaw"
unit = "deg"

[signal.away]
frame = "map"
in = "laser"
path = "distance"
max_age = "200 ms"
"""
NAMES = ("x", "heading", "away")


def recorded(path: Path, sent: Sequence[Sent], names: Sequence[str] = NAMES) -> Recording:
    recording = read(str(write(path, sent)), declare(BINDINGS), names)
    assert isinstance(recording, Recording)
    return recording


def arrived(sent: Sequence[Sent]) -> dict[str, list[tuple[int, float]]]:
    """The samples that a watch reads."""
    decoder = Decoder(declare(BINDINGS))
    samples: dict[str, list[tuple[int, float]]] = {name: [] for name in NAMES}
    for one in sent:
        encoding = "ros2msg" if one.encoding == "cdr" else "ros1msg"
        text = definition(one.type, one.encoding)
        channel = Channel(one.topic, one.encoding, one.type, encoding, text)
        messages, problems = decoder.read(Arrival(channel, one.payload, one.time, one.time))
        assert not problems
        for message in messages:
            for name, (value, _, _) in message.values.items():
                samples[name].append((message.time, value))
    return samples


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["cdr", "json"])
def test_a_drive_gives_the_poses_of_its_stamps(tmp_path: Path, encoding: str) -> None:
    log = recorded(tmp_path / "run.mcap", drive(200, encoding))
    assert not [each for each in log.findings if each.is_error]
    x, heading = log.samples["x"], log.samples["heading"]
    known = ~np.isnan(x.values)
    stamps = x.times[known] - 3 * MS
    at = (stamps - S) / S  # Beside a localization, the stamp is still that of the odometry.
    at = np.floor(at * 50 + 1e-6) / 50
    assert known.sum() > 140
    assert x.values[known] == pytest.approx(1 + at + 0.2 * np.cos(at / 2), abs=1e-9)
    assert heading.base[known[-len(heading.base) :]] == pytest.approx(at / 2, abs=1e-9)


@pytest.mark.slow
def test_a_recording_has_the_answers_of_tf2(tmp_path: Path) -> None:
    """After each message of each scenario, its last sample is what tf2 said."""
    checked = 0
    for i, scenario in enumerate(ANSWERS.read_text().split("new\n")[1:]):
        sent: list[Sent] = []
        asked: list[tuple[int, str, str, list[str]]] = []
        for line in scenario.splitlines():
            words = line.split()
            if words[0] == "put":
                each = transform(words)
                topic = "/tf_static" if words[1] == "1" else "/tf"
                pose = each.stamp, each.parent, each.child, each.translation, each.rotation
                sent.append(transforms(topic, S + len(sent) * MS, pose))
            elif sent and sent[-1].topic == "/tf":
                asked.append((sent[-1].time, words[1], words[2], words[4:]))
        if not asked:
            continue
        tables = "".join(
            f'[signal.s{k}]\nframe = "{source}"\nin = "{target}"\npath = "x"\n'
            for k, (_, target, source, _) in enumerate(asked)
        )
        declared = declare('[clock]\ntick = "1 ms"\n' + tables)
        log = read(str(write(tmp_path / f"{i}.mcap", sent)), declared, list(declared.signals))
        assert isinstance(log, Recording)
        for k, (time, _, _, answer) in enumerate(asked):
            samples = log.samples[f"s{k}"]
            last = samples.values[np.searchsorted(samples.times, time, "right") - 1]
            expected = np.nan if answer == ["none"] else float(answer[1])
            assert last == pytest.approx(expected, abs=1e-9, nan_ok=True)
            checked += 1
    assert checked > 100


@pytest.mark.slow
@examples(20)
@given(st.integers(0, 2**32))
def test_a_watch_reads_the_samples_of_its_recording(seed: int) -> None:
    from tempfile import TemporaryDirectory

    chance = random.Random(seed)
    sent = [one for one in drive(chance.randint(1, 25)) if chance.random() < 0.9]
    for place in chance.sample(range(len(sent)), min(2, len(sent))):
        if sent[place].topic == "/tf":
            sent[place] = replace(sent[place], payload=sent[place].payload[:-40])
    with TemporaryDirectory() as folder:
        if not any(one.topic == "/tf" for one in sent):
            return
        log = recorded(Path(folder) / "run.mcap", sent)
    live = arrived(sent)
    for name in NAMES:
        samples = log.samples[name]
        assert samples.times.tolist() == [time for time, _ in live[name]]
        assert samples.values == pytest.approx([value for _, value in live[name]], nan_ok=True)


def test_a_message_that_cannot_be_read_is_unknown_and_counted(tmp_path: Path) -> None:
    sent = drive(30)
    broken = next(i for i, one in enumerate(sent) if one.time > 1.3 * S)
    sent[broken] = replace(sent[broken], payload=sent[broken].payload[:50])
    log = recorded(tmp_path / "run.mcap", sent)
    assert Code.BAD_MESSAGE in [each.code for each in log.findings]
    x = log.samples["x"]
    assert np.isnan(x.values[x.times == sent[broken].time]).all()
    later = x.values[x.times > sent[broken].time]
    assert np.isnan(later[0]), "transforms between the lost ones are not interpolated"


@pytest.mark.slow
def test_nothing_is_interpolated_across_lost_messages(tmp_path: Path) -> None:
    """A chunk of messages is lost: the localization after it has no stamp before it any more."""
    sent = drive(250)
    path = write(tmp_path / "run.mcap", sent, compression=NONE, per_chunk=20)
    whole = recorded(tmp_path / "whole.mcap", sent)
    data = bytearray(path.read_bytes())
    data[data.index(sent[100].payload) + 100] ^= 1
    path.write_bytes(data)
    log = read(str(path), declare(BINDINGS), NAMES)
    assert isinstance(log, Recording)
    ((_, lost),) = log.gaps
    x = log.samples["x"]
    after = x.values[x.times > lost]
    assert len(after) > 50
    assert np.isnan(after[:40]).all(), "AMCL is a second ahead"
    assert not np.isnan(after[-1])
    known = whole.samples["x"].values[whole.samples["x"].times > lost]
    assert not np.isnan(known).any()


def test_a_log_without_the_frames_is_named(tmp_path: Path) -> None:
    log = recorded(tmp_path / "run.mcap", drive(100)[1:])
    assert [each.message for each in log.findings if each.code is Code.NO_TRANSFORM] == [
        "the transforms of the log never give x of laser in map",
        "the transforms of the log never give distance of map in laser",
    ]
    helps = {each.help for each in log.findings if each.code is Code.NO_TRANSFORM}
    assert helps == {"the log has no frame `laser`, but base_link, map, odom"}


def test_transforms_of_another_type_are_refused(tmp_path: Path) -> None:
    other = Sent("/tf", "std_msgs/msg/Float64", b"\0\1\0\0" + bytes(8), S)
    log = recorded(tmp_path / "run.mcap", [other])
    assert {each.code for each in log.findings} == {Code.WRONG_TYPE}
    assert not len(log.samples["x"].times)
