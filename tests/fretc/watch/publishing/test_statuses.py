"""What is published of a requirement: a violation first, then what cannot be relied on."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from fretc.watch.publishing.statuses import SOURCES, statuses
from fretc.watch.session import Session
from monitors.kernel.verdicts import Truth
from monitors.stop_supervisor import ERROR, OK, STALE, WARN, State, Status, status_of
from tests.fretc.watch.sent import Sent, Setting, plan_of

VERDICTS = ("satisfied", "violated", "inconclusive", "vacuous", "no data")
states = st.builds(
    State,
    st.just("R0"),
    st.sampled_from(VERDICTS),
    st.sampled_from([True, False, None]),
    *[st.none() | st.integers(0, 9)] * 4,
)


@given(states, st.sampled_from(["", "gone"]), st.booleans())
def test_red_is_never_lost_and_green_has_nothing_pending(
    state: State, fault: str, violated: bool
) -> None:
    level = status_of(state, fault, violated=violated).level
    assert (level == ERROR) == (violated or state.verdict == "violated")
    assert level != OK or (state.obligation_pending is False and not fault)
    assert level != WARN or state.obligation_pending is not False


def test_each_level_is_that_of_the_table() -> None:
    def level(verdict: str, obligation_pending: Truth, fault: str) -> int:
        return status_of(
            State("R0", verdict, obligation_pending, None, None, None, None), fault
        ).level

    for verdict, obligation_pending, fault in product(VERDICTS, (True, False, None), ("", "gone")):
        expected = STALE if fault else OK if obligation_pending is False else WARN
        expected = ERROR if verdict == "violated" else expected
        assert level(verdict, obligation_pending, fault) == expected


def of(session: Session) -> dict[str, Status]:
    return {each.name: each for each in statuses(session, session.states(), ())}


def test_what_has_not_come_or_is_gone_is_stale() -> None:
    session = Session(plan_of(Setting(slow="y < 5")))
    assert {each.level for each in of(session).values()} == {STALE}
    assert "/y" in of(session)["R2"].message
    session.arrive(Sent("/x", 9.0, 0).arrival)
    session.arrive(Sent("/y", 9.0, 0).arrival)
    session.arrive(Sent("/x", 9.0, 40).arrival)
    found = of(session)
    assert found[SOURCES].level == OK
    assert dict(found[SOURCES].values)["messages of /x"] == "2"
    assert found["R0"].level == OK
    session.interrupt()
    assert {each.level for each in of(session).values()} == {STALE}


def test_the_topics_of_a_requirement_are_those_that_its_propositions_read() -> None:
    reads = Session(plan_of(Setting(slow="y < 5"))).reads
    assert reads["R0"] == ("/x", "/y")
    assert reads["R3"] == ("/x", "/y")
