"""A result without a verdict says when its inputs were unknown, and why."""

from dataclasses import replace

import numpy as np
import pytest

from fretc.audit.measurements.unknown_inputs import MOST
from fretc.logs.signals.samples import Late, Recording, Samples
from tests.fretc.audit.test_one_log import FAR, NEAR, STILL, S, audited, recorded

SENTENCE = "whenever near the robot shall immediately satisfy still"
NAN = float("nan")


def moved(recording: Recording, name: str, times: list[int]) -> Recording:
    """The recording with the samples of a signal at other times, all of value `STILL`."""
    samples = Samples(np.array(times, np.int64) * S, np.full(len(times), STILL))
    return replace(recording, samples={**recording.samples, name: samples})


def words(recording: Recording) -> list[str]:
    evidence = audited(SENTENCE, recording)
    assert evidence.verdict == "no data"
    return [one.in_words(evidence.clock) for one in evidence.unknown_inputs]


def test_a_value_that_is_no_measurement() -> None:
    log = recorded([FAR, FAR, NAN, NAN, FAR], [STILL] * 5)
    assert words(log) == ["`near` from 2 s to 4 s (2 s): `d` was no measurement"]


def test_a_sample_that_is_too_old() -> None:
    log = moved(recorded([NEAR] * 8, [STILL] * 8), "v", [0, 1, 7])
    assert words(log) == ["`still` from 5 s to 7 s (2 s): the last sample of `v` was too old"]


def test_a_signal_that_has_not_begun() -> None:
    log = moved(recorded([NEAR] * 4, [STILL] * 4), "v", [2, 3])
    assert words(log) == ["`still` from 0 s to 2 s (2 s): `v` had no sample yet"]


def test_messages_that_came_too_late() -> None:
    late = {"/scan": Late(np.array([S], np.int64), np.array([2 * S], np.int64))}
    log = replace(recorded([NEAR] * 4, [0.4, STILL, STILL, STILL]), late=late)
    log = replace(log, samples=recorded([FAR] * 4, [0.4] * 4).samples)
    assert words(log) == ["`near` from 1 s to 3 s (2 s): messages of `d` came too late"]


@pytest.mark.slow
def test_the_first_hundred_are_kept_in_order_of_time() -> None:
    log = recorded([FAR, NAN] * 150, [0.4] * 300)
    found = audited(SENTENCE, log).unknown_inputs
    assert [one.first_tick for one in found] == [*range(1, 2 * MOST, 2)]


def test_a_result_with_a_verdict_keeps_none() -> None:
    log = recorded([FAR, NAN, FAR, NEAR], [STILL] * 4)
    evidence = audited(SENTENCE, log)
    assert (evidence.verdict, evidence.unknown_inputs) == ("satisfied", ())
