"""A node's core: the robot stands unless everything is known, readable and recent, and nothing is
pending."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.project.folder import load
from compiler.targets.python import monitor, perception
from monitors.loading import executed
from monitors.perception import OnlineEvaluator
from monitors.stop_supervisor import ERROR, OK, STALE, WARN, StopSupervisor, single_signals, stamp
from tests.json_schemas import validate

MS = 10**6
BINDINGS = """
[clock]
tick = "100 ms"
[signal.x]
path = "/x.data"
type = "std_msgs/Float64"
max_age = "1 s"
[signal.y]
path = "/y.a.data"
type = "a_msgs/Y"
[proposition.near]
expr = "x < 1"
[proposition.still]
expr = "y < 1"
[proposition.slow]
expr = "y < 2"
"""
SENTENCES = {
    "STOP": "whenever near the robot shall within 3 ticks satisfy still",
    "SLOW": "the robot shall always satisfy slow",
}


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Any]:
    """The emitted texts: the monitors, and what is around them."""
    folder = tmp_path_factory.mktemp("requirements")
    (folder / "bindings.toml").write_text(BINDINGS)
    for id, sentence in SENTENCES.items():
        (folder / f"{id}.fret").write_text(sentence)
    requirements = load(sorted(map(str, folder.glob("*.fret")))).formalized
    assert len(requirements) == 2
    return executed(monitor.text(*requirements), "m"), executed(perception.text(requirements), "p")


class Run:
    """A supervisor, to which messages come every 10 ms."""

    def __init__(self, emitted: tuple[Any, Any], *deciding: str, timeout: float = 0.5) -> None:
        monitors, live = emitted
        self.supervisor: StopSupervisor = live.StopSupervisor(
            monitors.MONITOR, live.SETTING, deciding, timeout
        )
        self.now = 5 * 10**9

    @property
    def steady(self) -> float:
        return self.now / 1e9

    def x(self, value: object) -> None:
        self.now += 10 * MS
        message = SimpleNamespace(data=value)
        self.supervisor.arrive("/x", message, self.now, self.steady)

    def y(self, value: object) -> None:
        self.now += 10 * MS
        message = SimpleNamespace(a=SimpleNamespace(data=value))
        self.supervisor.arrive("/y", message, self.now, self.steady)

    def idle(self, milliseconds: int) -> None:
        for _ in range(milliseconds // 10):
            self.now += 10 * MS
            self.supervisor.pass_to(self.now)

    @property
    def stop(self) -> bool:
        return self.supervisor.stop(self.steady)

    def levels(self) -> dict[str, int]:
        return {each.name: each.level for each in self.supervisor.statuses(self.steady)}


def test_the_robot_stands_until_each_topic_that_decides_has_begun(emitted: Any) -> None:
    run, slow = Run(emitted), Run(emitted, "SLOW")
    assert run.stop
    assert run.levels() == {"sources": STALE, "SLOW": STALE, "STOP": STALE}
    run.x(5.0)
    assert run.stop
    run.y(0.0)
    run.idle(10)  # the first tick is over
    assert not run.stop
    assert run.levels() == {"sources": OK, "SLOW": OK, "STOP": OK}
    slow.y(0.0)
    slow.idle(200)
    assert not slow.stop  # it does not read /x
    assert slow.levels() == {"sources": STALE, "SLOW": OK, "STOP": STALE}


def test_it_stops_on_arrival_and_goes_on_once_nothing_is_pending(emitted: Any) -> None:
    run = Run(emitted, "STOP")
    run.x(5.0)
    run.y(1.5)
    run.idle(10)
    assert not run.stop
    run.x(0.5)
    assert run.stop
    assert run.levels()["STOP"] == WARN
    run.idle(100)
    run.y(0.0)
    run.x(5.0)
    run.idle(100)
    assert not run.stop


def test_silence_and_what_cannot_be_read_stop_it(emitted: Any) -> None:
    run = Run(emitted)
    run.x(5.0)
    run.y(0.0)
    run.idle(480)
    assert not run.stop
    run.idle(30)  # of /x; the samples of /y do not age
    assert run.stop
    assert run.levels() == {"sources": STALE, "SLOW": OK, "STOP": STALE}
    run.x(5.0)
    assert not run.stop
    run.x("five")
    assert run.stop
    assert run.levels()["STOP"] == STALE
    run.x(float("nan"))
    assert run.stop
    assert run.levels()["STOP"] == WARN
    run.x(5.0)
    assert not run.stop


def test_a_topic_that_is_refused_is_unknown_until_its_next_message(emitted: Any) -> None:
    """Also one whose samples do not age: nobody judges by the last of them."""
    run = Run(emitted, "SLOW")
    run.y(0.0)
    run.idle(1000)
    assert not run.stop
    run.supervisor.refuse("/y", "a robot lies", run.now)  # at 6.01 s
    assert run.stop
    run.idle(500)
    run.supervisor.refuse("/y", "a robot lies", run.now)
    assert run.stop
    (status,) = [each for each in run.supervisor.statuses(run.steady) if each.name == "SLOW"]
    assert status.message == "a message of /y cannot be read: a robot lies"
    run.y(0.0)  # at 6.52 s
    run.idle(200)
    rows = run.supervisor._evaluator.ledger
    slow = [(rows.time(i), dict(rows.row(i))["slow"]) for i in range(len(rows) - 11, len(rows))]
    assert slow[0][0] == 5_710 * MS
    assert slow[-1][0] == 6_710 * MS
    assert [known for _, known in slow] == [True] * 3 + [None] * 6 + [True] * 2


def test_a_clock_that_is_set_begins_another_run_and_no_violation_is_forgotten(emitted: Any) -> None:
    run = Run(emitted, "STOP")
    run.x(5.0)
    run.y(3.0)
    run.idle(200)
    assert run.levels()["SLOW"] == ERROR
    assert not run.stop
    run.now -= 4 * 10**9
    run.x(5.0)
    assert run.stop  # nothing is known of /y in this run
    run.y(0.0)
    run.idle(100)
    assert not run.stop
    assert run.levels() == {"sources": OK, "SLOW": ERROR, "STOP": OK}


def test_news_are_lines_of_a_watch(emitted: Any) -> None:
    run = Run(emitted)
    found = []
    for x, y in [(5.0, 0.0), (0.5, 0.0), (0.5, 3.0), (0.5, 3.0), (5.0, 3.0)]:
        run.x(x)
        run.y(y)
        run.idle(100)
        found += run.supervisor.news()
    assert run.supervisor.news() == []
    for line in found:
        validate("watch.schema.json", line)
    last = {line["requirement"]: line for line in found}
    assert last["SLOW"]["verdict"] == "violated"
    assert last["SLOW"]["violated_ns"] is not None
    assert last["STOP"]["triggered_ns"] is not None


@given(
    st.lists(st.tuples(st.sampled_from("xyi"), st.sampled_from([0.5, 1.5, 3.0, float("nan"), "?"])))
)
def test_it_stops_unless_pending_is_false_and_all_is_there(
    emitted: Any, steps: list[tuple[str, Any]]
) -> None:
    """By the demand of `OnlineEvaluator`, and by what came last of each topic."""
    monitors, live = emitted
    run, judging = Run(emitted), live.OnlineEvaluator(monitors.MONITOR, live.SETTING)
    heard: dict[str, float] = {}
    broken: set[str] = set()
    for kind, value in steps:
        if kind == "i":
            run.idle(250)
            for at in range(run.now - 240 * MS, run.now + MS, 10 * MS):
                judging.pass_to(at)
        else:
            getattr(run, kind)(value)
            message = SimpleNamespace(data=value, a=SimpleNamespace(data=value))
            if value == "?":
                broken.add(kind)
                judging.pass_to(run.now)
            else:
                judging.arrive(f"/{kind}", run.now, run.now, message)
                broken.discard(kind)
                heard[kind] = run.steady
        silent = len(heard) < 2 or run.steady - heard["x"] > 0.5
        pending = any(each is not False for each in judging.obligation_pending())
        assert run.stop == bool(silent or broken or pending)


def test_parameters_are_checked(emitted: Any) -> None:
    with pytest.raises(ValueError, match="unknown requirement OTHER: there are SLOW, STOP"):
        Run(emitted, "OTHER")
    for timeout in (-1.0, float("nan"), 1e9):
        with pytest.raises(ValueError, match="source_timeout is from 0 to"):
            Run(emitted, timeout=timeout)


@cache
def _fields(kind: str) -> Any:
    inner = SimpleNamespace(data=0.0, types={"data": kind})
    return SimpleNamespace(a=inner, types={"a": "a_msgs/Inner"})


@pytest.mark.parametrize(
    ("kind", "single"),
    [
        ("float32", True), ("float32[]", True), ("float32[3]", True), ("float", True),
        ("sequence<float>", True), ("sequence<float, 3>", True), ("float[3]", True),
        ("float64", False), ("double", False), ("float64[]", False), ("sequence<double>", False),
        ("int32", False), ("floaty_msgs/Thing", False),
    ],
)  # fmt: skip
def test_32_bit_floats_are_known_by_the_names_of_both_middlewares(
    emitted: Any, kind: str, single: bool
) -> None:
    setting = emitted[1].SETTING
    found = single_signals(setting, "/y", _fields(kind), lambda message: message.types)
    assert found == (("y",) if single else ())
    with pytest.raises(ValueError, match=r"SimpleNamespace of /x has no field data"):
        single_signals(setting, "/x", _fields(kind), lambda message: message.types)


def test_stamps_of_both_middlewares_are_read() -> None:
    two = SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(sec=1, nanosec=5)))
    one = SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(secs=2, nsecs=7)))
    assert [stamp(two), stamp(one), stamp(SimpleNamespace())] == [10**9 + 5, 2 * 10**9 + 7, None]


def test_the_ticks_before_a_jump_are_judged(emitted: Any) -> None:
    monitors, live = emitted
    judging: OnlineEvaluator = live.OnlineEvaluator(monitors.MONITOR, live.SETTING)
    for name in ("/x", "/y"):
        message = SimpleNamespace(data=3.0, a=SimpleNamespace(data=3.0))
        judging.arrive(name, 5 * 10**9, 5 * 10**9, message)
    before = judging.monitor
    assert before.tick == -1
    judging.arrive("/x", 10**9, 6 * 10**9, SimpleNamespace(data=3.0))
    assert judging.resets == 1
    assert before.tick == 9
    assert str(before.statuses()[0].verdict) == "violated"
