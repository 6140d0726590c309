from math import inf
from typing import Any

import pytest

from compiler.files.checked_json import MisshapenError, Shape
from fretc.audit.evidence.samples import Samples, Window, window

WRITTEN: dict[str, Any] = {
    "start_ns": 1_000,
    "end_ns": 4_000_001_000,
    "samples": {"vx": {"times_ns": [0, 1_000, 2_000_001_000], "values": [0.5, None, "-inf"]}},
}


def changed(**changes: Any) -> Shape:
    return Shape({**WRITTEN, **changes}, "window")


def test_times_count_in_seconds_from_the_first_tick() -> None:
    assert window(Shape(WRITTEN), 1_000) == Window(
        0.0, 4.0, {"vx": Samples((-1e-6, 0.0, 2.0), (0.5, None, -inf))}
    )


def test_the_value_in_force_is_the_last_one_before() -> None:
    samples = Samples((1.0, 2.0, 3.0), (0.5, None, 7.0))
    assert [samples.at(t) for t in (0.9, 1.0, 1.9, 2.5, 9.0)] == [None, 0.5, 0.5, None, 7.0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start_ns": 1.5}, "`window.start_ns` must be a whole number, and is `1.5`"),
        ({"end_ns": 0}, "`window` must be a stretch of time that ends after its start"),
        ({"samples": []}, "`window.samples` must be an object, and is an array"),
        (
            {"samples": {"vx": {"times_ns": [2, 1], "values": [1.0, 2.0]}}},
            '`window.samples["vx"].times_ns` must be times in their order, and is an array',
        ),
        (
            {"samples": {"vx": {"times_ns": [1], "values": []}}},
            '`window.samples["vx"]` must be as many times as values, and is an object',
        ),
        (
            {"samples": {"vx": {"times_ns": [True], "values": [1.0]}}},
            '`window.samples["vx"].times_ns[0]` must be a whole number, and is true',
        ),
        (
            {"samples": {"vx": {"times_ns": [1], "values": ["inf"]}}},
            '`window.samples["vx"].values[0]` must be one of +inf, -inf, and is `inf`',
        ),
    ],
)
def test_a_wrong_shape_is_told_with_its_place(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(MisshapenError) as error:
        window(changed(**changes), 0)
    assert str(error.value).startswith(message)
