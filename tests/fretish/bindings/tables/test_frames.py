"""The tables of signals of frames."""

from fractions import Fraction

import pytest

from fretish.bindings.canonical import signal_fields
from fretish.bindings.declarations import FramePose, PoseNumber, Signal
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source

CLOCK = '[clock]\ntick = "1 s"\n'


def declared(table: str, clock: str = CLOCK) -> tuple[Signal | None, tuple[Diagnostic, ...]]:
    found, wrong = read_bindings(Source("bindings.toml", f"{clock}[signal.s]\n{table}\n"))
    return (None if found is None else found.signals.get("s")), wrong


def test_a_signal_of_frames_has_the_base_unit_of_its_number() -> None:
    signal, wrong = declared('frame = "base_link"\nin = "/map"\npath = "yaw"\nunit = "deg"')
    assert wrong == ()
    assert signal is not None
    assert signal.pose == FramePose("base_link", "map", PoseNumber.YAW)
    assert str(signal.path) == "/tf.transforms"
    assert (signal.unit_name, signal.scale) == ("deg", Fraction(1))
    assert signal.origin == "yaw of base_link in map"
    plain, _ = declared('frame = "a"\nin = "b"\npath = "distance"\ntopic = "/r1/tf"')
    assert plain is not None
    assert (plain.unit_name, plain.path.topic) == ("m", "/r1/tf")


def test_each_part_of_a_pose_counts_in_the_fingerprint() -> None:
    texts = [
        'frame = "a"\nin = "b"\npath = "x"',
        'frame = "b"\nin = "a"\npath = "x"',
        'frame = "a"\nin = "b"\npath = "y"',
        'frame = "a"\nin = "b"\npath = "x"\ntopic = "/r1/tf"',
    ]
    signals = [declared(text)[0] for text in texts]
    fields = [repr(signal_fields(signal)) for signal in signals if signal is not None]
    assert len({*fields}) == len(texts)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('frame = "a"\npath = "x"', "`in` does not name a frame"),
        ('frame = " "\nin = "b"\npath = "x"', "`frame` does not name a frame"),
        ('frame = "a"\nin = "/a"\npath = "x"', "`frame` and `in` name the same frame, `a`"),
        ('frame = "a"\nin = "b"\npath = "w"', "`path` does not name a number of a pose"),
        ('frame = "a"\nin = "b"', "`path` does not name a number of a pose"),
        (
            'frame = "a"\nin = "b"\npath = "x"\nunit = "deg"',
            "x is a length, and `deg` is another unit",
        ),
        (
            'frame = "a"\nin = "b"\npath = "x"\ntopic = "a b"',
            "`topic` does not name a topic of transforms",
        ),
        (
            'frame = "a"\nin = "b"\npath = "x"\nvalid = "x < 1"',
            "unknown field `valid` in [signal.s] with `frame`",
        ),
    ],
)
def test_mistakes_are_named(table: str, message: str) -> None:
    signal, wrong = declared(table)
    assert signal is None
    assert [each.message for each in wrong] == [message]


def test_a_clock_by_stamps_is_refused() -> None:
    clock = '[clock]\ntick = "1 s"\ntime = "header.stamp"\nlateness = "0 s"\n'
    signal, wrong = declared('frame = "a"\nin = "b"\npath = "x"', clock)
    assert signal is None
    assert [each.code for each in wrong] == [Code.BAD_FRAMES]
