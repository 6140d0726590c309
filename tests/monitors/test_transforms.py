"""Poses of frames: tf2 itself, compiled from its sources, has given the expected answers."""

import math
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from monitors.transforms import (
    FrameQuery,
    FrameSignals,
    FrameTransform,
    Pose,
    TransformBuffer,
    pose_number,
    transforms_of,
)
from tests.test_layers import ROOT

ANSWERS = ROOT / "tests/data/tf2_answers.txt"
ANGLES = ("yaw", "pitch", "roll")
S = 10**9


def transform(words: list[str]) -> FrameTransform:
    """The transform of a line `put`."""
    numbers = tuple(map(float, words[5:]))
    return FrameTransform(int(words[2]), words[3], words[4], numbers[:3], numbers[3:])


def questions(path: Path) -> Iterator[tuple[TransformBuffer, str, str, list[str]]]:
    """Each question to tf2 with the buffer at that time, and the answer."""
    buffer = TransformBuffer()
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "new":
            buffer = TransformBuffer()
        elif words[0] == "put":
            buffer.put(transform(words), static=words[1] == "1")
        elif words[0] == "ask":
            yield buffer, words[1], words[2], words[4:]


def close(angle: float, other: float) -> bool:
    return abs(math.remainder(angle - other, 2 * math.pi)) < 1e-9


def test_every_pose_is_that_of_tf2() -> None:
    known = unknown = 0
    for buffer, target, source, answer in questions(ANSWERS):
        time = buffer.latest_common_time(target, source)
        pose = None if time is None else buffer.lookup(target, source, time)
        if answer == ["none"]:
            assert pose is None
            unknown += 1
            continue
        assert pose is not None
        assert time == int(answer[0])
        numbers = list(map(float, answer[1:]))
        assert pose[0] == pytest.approx(numbers[:3], abs=1e-9)
        assert abs(sum(a * b for a, b in zip(pose[1], numbers[3:7], strict=True))) == (
            pytest.approx(1, abs=1e-9)
        )
        if abs(abs(numbers[8]) - math.pi / 4) > 1e-9:  # at a pole, tf2 halves the pitch twice
            assert all(map(close, [pose_number(n, pose) or 0.0 for n in ANGLES], numbers[7:]))
        known += 1
    assert known > 100
    assert unknown > 50


def test_the_numbers_of_a_pose() -> None:
    upside = (0.0, math.sin(math.pi / 4), 0.0, math.cos(math.pi / 4))
    numbers = {
        name: pose_number(name, Pose((3.0, 4.0, 12.0), upside))
        for name in ("x", "y", "z", "distance", *ANGLES)
    }
    assert numbers["x"] == 3.0
    assert numbers["distance"] == 13.0
    assert numbers["pitch"] == pytest.approx(math.pi / 2)
    assert pose_number("x", Pose((math.inf, 0.0, 0.0), upside)) is None


def query(target: str = "map") -> FrameSignals:
    return FrameSignals([FrameQuery("x", "/tf", "base", target, "x")])


def moved(stamp: int, x: float, parent: str = "map", child: str = "base") -> FrameTransform:
    return FrameTransform(stamp, parent, child, (x, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def test_a_message_that_does_not_change_the_answer_gives_no_sample() -> None:
    signals = query()
    assert signals.take("/tf", [moved(S, 1.0)]) == {"x": 1.0}
    assert signals.take("/tf", [moved(S, 1.0)]) == {}
    assert signals.take("/tf", [moved(2 * S, 1.0, child="other")]) == {}
    assert signals.take("/tf", [moved(2 * S, 1.0)]) == {"x": 1.0}, "for a later stamp"


def test_a_frame_whose_transforms_have_ceased_gives_no_samples_and_then_unknown() -> None:
    signals = query("map")
    signals.take("/tf", [moved(S, 1.0, "map", "odom"), moved(S, 1.0, "odom", "base")])
    assert signals.take("/tf", [moved(2 * S, 5.0, "odom", "base")]) == {}
    assert signals.take("/tf", [moved(11 * S, 5.0, "odom", "base")]) == {}
    assert signals.take("/tf", [moved(12 * S, 5.0, "odom", "base")]) == {}
    assert signals.take("/tf", [moved(13 * S, 5.0, "odom", "base")]) == {"x": None}


def test_static_transforms_count_from_the_next_message_on_and_survive_a_loss() -> None:
    signals = FrameSignals([FrameQuery("x", "/tf", "laser", "map", "x")])
    assert signals.take("/tf", [moved(S, 1.0)]) == {"x": None}
    assert signals.take("/tf_static", [moved(0, 0.5, "base", "laser")]) == {}
    assert signals.take("/tf", [moved(2 * S, 1.0)]) == {"x": 1.5}
    assert signals.lose("/tf") == {"x": None}
    assert signals.take("/tf", [moved(2 * S, 1.0, child="other")]) == {"x": None}
    assert signals.take("/tf", [moved(3 * S, 2.0)]) == {"x": 2.5}


def test_a_loop_is_unknown() -> None:
    signals = query()
    loop = [moved(S, 1.0, "a", "base"), moved(S, 1.0, "base", "a")]
    assert signals.take("/tf", loop) == {"x": None}


@pytest.mark.parametrize("names", [("sec", "nanosec"), ("secs", "nsecs")])
def test_messages_of_both_versions_of_ros_are_read(names: tuple[str, str]) -> None:
    stamp = SimpleNamespace(**dict(zip(names, (3, 7), strict=True)))
    message = SimpleNamespace(
        transforms=[
            SimpleNamespace(
                header=SimpleNamespace(stamp=stamp, frame_id="/map"),
                child_frame_id="base",
                transform=SimpleNamespace(
                    translation=SimpleNamespace(x=1, y=2, z=3),
                    rotation=SimpleNamespace(x=0, y=0, z=0, w=1),
                ),
            )
        ]
    )
    (read,) = transforms_of(message)
    assert read == FrameTransform(3 * S + 7, "map", "base", (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
