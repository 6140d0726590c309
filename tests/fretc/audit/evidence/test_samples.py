from math import inf
from typing import Any

import pytest

from compiler.files.checked_json import SchemaError
from compiler.files.records import decoded
from fretc.audit.evidence.samples import RunPart, SignalSamples, Surroundings, window

RECORD: dict[str, Any] = {
    "start_ns": 1_000,
    "end_ns": 4_000_001_000,
    "samples": {"vx": {"times_ns": [0, 1_000, 2_000_001_000], "values": [0.5, None, "-inf"]}},
}


def changed(**changes: Any) -> Surroundings:
    return decoded({**RECORD, **changes}, Surroundings)


def test_times_count_in_seconds_from_the_first_tick() -> None:
    assert window(changed(), 1_000) == RunPart(
        0.0, 4.0, {"vx": SignalSamples((-1e-6, 0.0, 2.0), (0.5, None, -inf))}
    )


def test_the_value_in_force_is_the_last_one_before() -> None:
    samples = SignalSamples((1.0, 2.0, 3.0), (0.5, None, 7.0))
    assert [samples.at(t) for t in (0.9, 1.0, 1.9, 2.5, 9.0)] == [None, 0.5, 0.5, None, 7.0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start_ns": 1.5}, "`$.start_ns`: expected `int`, got `float`"),
        ({"end_ns": 0}, "expected a stretch of time that ends after its start"),
        ({"samples": []}, "`$.samples`: expected `object`, got `array`"),
        (
            {"samples": {"vx": {"times_ns": [2, 1], "values": [1.0, 2.0]}}},
            "`$.samples[...]`: expected times in their order",
        ),
        (
            {"samples": {"vx": {"times_ns": [1], "values": []}}},
            "`$.samples[...]`: expected as many times as values",
        ),
        (
            {"samples": {"vx": {"times_ns": [True], "values": [1.0]}}},
            "`$.samples[...].times_ns[0]`: expected `int`, got `bool`",
        ),
        (
            {"samples": {"vx": {"times_ns": [1], "values": ["inf"]}}},
            "`$.samples[...].values[0]`: invalid enum value 'inf'",
        ),
    ],
)
def test_a_wrong_shape_is_told_with_its_place(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(SchemaError) as error:
        changed(**changes)
    assert str(error.value).startswith(message)
