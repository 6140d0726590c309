"""Stretches lie where the ticks do, whatever the evidence has times of."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from compiler.files.records import replace
from fretc.audit.evidence.schema import Result
from fretc.report.across.stretches import stretches
from tests.fretc.audit.results import result

TICK = 10**8


def at(tick: int, **more: Any) -> dict[str, Any]:
    return {"tick": tick, "ns": 10**9 + tick * TICK, "seconds": tick / 10, **more}


def broken(first: int, last: int) -> dict[str, Any]:
    times = {"start_ns": 10**9 + first * TICK, "end_ns": 10**9 + last * TICK}
    return {
        "first_tick": first,
        "last_tick": last,
        "start_s": first / 10,
        "end_s": last / 10,
        **times,
    }


def run(**fields: Any) -> Result:
    found = result(start_ns=10**9, end_ns=11 * 10**9, **fields)
    return replace(found, ticks=100, unknown=tuple(map(tuple, fields.get("unknown", ()))))


ticks = st.integers(0, 99)
pairs = st.tuples(ticks, ticks).map(lambda pair: (min(pair), max(pair)))


@given(st.lists(pairs, max_size=3), st.lists(pairs, max_size=3), st.lists(ticks, max_size=3), ticks)
def test_a_stretch_is_from_its_first_tick_to_the_end_of_its_last(
    violated: list[tuple[int, int]], unknown: list[tuple[int, int]], late: list[int], known: int
) -> None:
    found = stretches(
        run(
            violations=[broken(*pair) for pair in violated],
            unknown=unknown,
            open=(),
            triggers=[at(tick) for tick in sorted(late)],
            states=[at(0, state="idle"), *([at(known, state="open")] if known else [])],
        )
    )
    assert list(found.violations) == [(a / 10, round((b + 1) / 10, 9)) for a, b in violated]
    for (start, end), (a, b) in zip(found.unknown, unknown, strict=True):
        assert abs(start - a / 10) < 1e-6
        assert abs(end - (b + 1) / 10) < 1e-6
    assert abs(found.length - 10) < 1e-6


def test_between_messages_of_the_clock_a_tick_lasts_until_the_next() -> None:
    """Ticks 0 to 3 are at 0, 1, 5 and 6 s."""
    states = [(0, 0, "idle"), (1, 1, "unknown"), (2, 5, "idle"), (3, 6, "unknown")]
    found = stretches(
        replace(
            run(
                states=[
                    {"tick": t, "ns": 10**9 + s * 10**9, "seconds": float(s), "state": word}
                    for t, s, word in states
                ]
            ),
            ticks=4,
            unknown=((1, 1), (3, 3)),
        )
    )
    assert found.unknown == ((1.0, 5.0), (6.0, 8.0))
