"""A run is as long as its ticks; of a clock without a period, as its messages."""

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.result_summaries import audited_s
from fretish.clock import Clock
from tests.fretc.audit.results import result


@given(st.integers(0, 10**6), st.integers(1, 10**10), st.integers(0, 10**12))
def test_a_run_is_as_long_as_its_ticks(ticks: int, period: int, span: int) -> None:
    clock = f"{Clock(period)}, by log_time"
    one = result(clock=clock, ticks=ticks, start_ns=5, end_ns=5 + span)
    assert audited_s(one) == ticks * period / 1e9
    by_message = result(clock="each message of /scan", ticks=ticks, start_ns=5, end_ns=5 + span)
    assert audited_s(by_message) == span / 1e9
    assert audited_s(result(clock=clock, ticks=ticks, start_ns=None, end_ns=None)) is None
