"""`[interceptor]` and `[assume]`: what each field means, and where its mistakes are reported."""

import pytest

from fretish.bindings.declarations import (
    Interception,
    InterceptorForm,
    LoopAssumptions,
    Planner,
    Requests,
)
from fretish.bindings.tables.interceptor import TABLE
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source

BEFORE = """\
[clock]
tick = "100 ms"

[signal.vx]
path = "/odom.twist.twist.linear.x"
unit = "m/s"

[proposition.stopped]
expr = "abs(vx) < 0.01 m/s"

"""
GOOD = f"""\
{BEFORE}[interceptor]
stop            = "/gwendolen_control"
command         = "/cmd_vel"
output          = "/cmd_vel_filtered"
scan            = "/scan"
period          = "50 ms"
hold            = "200 ms"
stop_timeout    = "1200 ms"
scan_timeout    = "300 ms"
command_timeout = "0.5 s"
form            = "timer"
latching        = true
ros             = 1

[assume]
stands   = "stopped"
latency  = "100 ms"
lost     = 1
requests = "edge"
planner  = "every tick"
braking  = "200 ms"
"""
MS = 1_000_000
HOLD = 'hold            = "200 ms"'
STANDS = '"stopped"\nlatency'


USELESS = '`heartbeat` has no effect with `requests = "level"`, which repeats at every tick'


EDGE = 'requests = "edge"'
NO_DURATION = "`heartbeat` must be a duration above 0"


def mistakes(text: str) -> list[str]:
    found, wrong = read_bindings(Source("b.toml", text))
    assert found is not None
    assert found.mistakes.keys() <= {("interceptor", ""), ("assume", ""), ("environment", "")}
    assert {*wrong} == {each for some in found.mistakes.values() for each in some}
    return [f"{d.code.number} {d.span.line if d.span else 0}: {d.message}" for d in wrong]


def test_both_tables_are_read() -> None:
    found, wrong = read_bindings(Source("b.toml", GOOD))
    assert wrong == ()
    assert found is not None
    assert found.interceptor == Interception(
        stop="/gwendolen_control",
        command="/cmd_vel",
        output="/cmd_vel_filtered",
        scan="/scan",
        period=50 * MS,
        hold=200 * MS,
        stop_timeout=1200 * MS,
        scan_timeout=300 * MS,
        command_timeout=500 * MS,
        form=InterceptorForm.TIMER,
        latching=True,
        ros=1,
    )
    assert found.assumed == LoopAssumptions(
        stands="stopped",
        latency=100 * MS,
        braking=200 * MS,
        lost=1,
        requests=Requests.EDGE,
        planner=Planner.EVERY_TICK,
    )


def test_what_is_left_out_is_not_watched_and_assumes_little() -> None:
    paper = '[interceptor]\nstop = "stop"\ncommand = "~/in"\noutput = "/out"\nform = "event"\n'
    assume = '[assume]\nstands = "stopped"\nlatency = "0 ms"\nbraking = "0 s"\n'
    found, wrong = read_bindings(Source("b.toml", BEFORE + paper + assume))
    assert wrong == ()
    assert found is not None
    assert found.interceptor == Interception("stop", "~/in", "/out", form=InterceptorForm.EVENT)
    assert found.assumed == LoopAssumptions("stopped", latency=0, braking=0)
    bare, wrong = read_bindings(Source("b.toml", BEFORE))
    assert wrong == ()
    assert bare is not None
    assert (bare.interceptor, bare.assumed) == (None, None)


def test_a_safety_function_may_repeat_itself() -> None:
    beating = GOOD.replace('requests = "edge"', 'requests = "edge"\nheartbeat = "0.45 s"')
    found, wrong = read_bindings(Source("b.toml", beating))
    assert wrong == ()
    assert found is not None
    assert found.assumed is not None
    assert (found.assumed.requests, found.assumed.heartbeat) == (Requests.EDGE, 450 * MS)


def test_an_interceptor_needs_no_clock() -> None:
    found, wrong = read_bindings(Source("b.toml", TABLE))
    assert wrong == ()
    assert found is not None
    assert found.interceptor is not None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ros  ", "rose ", "F302 23: unknown field `rose` in [interceptor]"),
        ('"/cmd_vel"', '"cmd vel"', "F303 13: `command` must be a topic"),
        ('"/cmd_vel"', '"/"', "F303 13: `command` must be a topic"),
        ('"/cmd_vel"', '"/2nd"', "F303 13: `command` must be a topic"),
        ('"/cmd_vel"', "3", "F303 13: `command` must be a topic"),
        ('"/cmd_vel"', '"/cmd_vel_filtered"', "F320 14: `output` is the same topic as `command`"),
        ('"/scan"', '"gwendolen_control"', "F320 15: `scan` is the same topic as `stop`"),
        ('scan            = "/scan"\n', "", "F303 11: `[interceptor]` has no `scan`"),
        ('period          = "50 ms"\n', "", "F303 11: `[interceptor]` has no `period`"),
        ('"50 ms"', '"0 ms"', "F303 16: `period` must be a duration above 0"),
        ('"50 ms"', '"50"', "F303 16: `period` must be a duration above 0"),
        ('"50 ms"', "0.05", "F303 16: `period` must be a duration above 0"),
        ('"50 ms"', "true", "F303 16: `period` must be a duration above 0"),
        (HOLD, 'hold = "0 s"', "F303 17: `hold` must be a duration above 0"),
        (HOLD, 'hold = "-1 s"', "F303 17: `hold` must be a duration above 0"),
        (HOLD, 'hold = "49 ms"', "F321 17: `hold` is shorter than `period`"),
        ('"1200 ms"', '"20 ms"', "F321 18: `stop_timeout` is shorter than `period`"),
        ('"timer"', '"timed"', "F303 21: `form` cannot be `timed`"),
        ("latching        = true", "latching = 1", "F303 22: `latching` must be true or false"),
        ("ros             = 1", "ros = 3", "F303 23: `ros` cannot be 3"),
        ("ros             = 1", "ros = true", "F303 23: `ros` must be 1 or 2"),
        (STANDS, "3\nlatency", "F303 26: `stands` must be the name of a proposition in quotes"),
        ('stands   = "stopped"\n', "", "F303 25: `[assume]` has no `stands`"),
        ('latency  = "100 ms"\n', "", "F303 25: `[assume]` has no `latency`"),
        ('latency  = "100 ms"', 'latency = "soon"', "F303 27: `latency` must be a duration"),
        ('braking  = "200 ms"\n', "", "F303 25: `[assume]` has no `braking`"),
        ("lost     = 1", "lost = -1", "F303 28: `lost` cannot be below 0"),
        ("lost     = 1", "lost = false", "F303 28: `lost` must be a whole number of messages"),
        ("lost     = 1", "lost = 0.5", "F303 28: `lost` must be a whole number of messages"),
        ('"edge"', '"edges"', "F303 29: `requests` cannot be `edges`"),
        ('"every tick"', '"never"', "F303 30: `planner` cannot be `never`"),
        (EDGE, f"{EDGE}\nheartbeat = 3", f"F303 30: {NO_DURATION}"),
        (EDGE, f'{EDGE}\nheartbeat = "0 s"', f"F303 30: {NO_DURATION}"),
        (EDGE, 'heartbeat = "1 s"', f"F303 29: {USELESS}"),
        (EDGE, 'heartbeat = "1 s"\nrequests = "level"', f"F303 29: {USELESS}"),
        (EDGE, 'heartbeat = "1 s"\nrequests = "edges"', "F303 30: `requests` cannot be `edges`"),
        ("planner ", "planer ", "F302 30: unknown field `planer` in [assume]"),
    ],
)  # fmt: skip
def test_each_mistake_has_its_place(old: str, new: str, message: str) -> None:
    assert GOOD.count(old) == 1, old
    assert mistakes(GOOD.replace(old, new)) == [message]


def test_the_event_form_measures_no_time() -> None:
    assert mistakes(GOOD.replace('"timer"', '"event"')) == [
        'F322 16: `period` needs a timer, and `form = "event"` has none',
        'F322 17: `hold` needs a timer, and `form = "event"` has none',
        'F322 18: `stop_timeout` needs a timer, and `form = "event"` has none',
        'F322 19: `scan_timeout` needs a timer, and `form = "event"` has none',
        'F322 20: `command_timeout` needs a timer, and `form = "event"` has none',
    ]


def test_a_table_must_be_one() -> None:
    text = f"interceptor = 3\nassume = []\n{BEFORE}"
    assert mistakes(text) == [
        "F303 1: `interceptor` must be a table",
        "F303 2: `assume` must be a table",
    ]


def test_a_mistake_is_told_with_its_fix() -> None:
    _, (wrong,) = read_bindings(Source("b.toml", GOOD.replace('"stopped"\nl', '"stoped"\nl')))
    assert render(wrong) == (
        "F309 `stands` names `stoped`, which is not a bound proposition\n"
        "  --> b.toml:26:12\n"
        '   | stands   = "stoped"\n'
        "   |            ^^^^^^^^\n"
        "help: declare `[proposition.stoped]`"
    )
