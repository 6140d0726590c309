"""`--emit interceptor`: the core as it is tested, the options, and a node that runs without ROS."""

import ast
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import inf, nan
from pathlib import Path
from threading import Event, Thread
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.emit import TARGETS
from compiler.targets.interceptor_options import options as counted
from compiler.targets.python.interceptor import MARKER, text
from compiler.targets.target import TargetOptions
from fretish.bindings.canonical import bound
from fretish.bindings.declarations import Declarations, Interception, InterceptorForm
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from monitors import interceptor
from monitors.loading import executed
from monitors.source_text import interceptor as core
from tests.command import Fretc, write
from tests.monitors.test_interceptor import events, options

MS = 1_000_000
NODE = Interception(
    "/stop", "/cmd_vel", "/wheels", "/scan", period=50 * MS, hold=90 * MS, stop_timeout=120 * MS
)
PAPER = Interception(
    "/stop", "/cmd_vel", "/wheels", form=InterceptorForm.EVENT, latching=True, ros=1
)
TARGET = TARGETS["interceptor"]
BINDINGS = """\
[clock]
tick = "100 ms"

[signal.x]
path = "/x.data"

[proposition.p]
expr = "x > 0"
"""
TABLE = """\
[interceptor]
stop    = "/stop"
command = "/cmd_vel"
output  = "/wheels"
"""


def declared(more: str) -> Declarations:
    found, wrong = read_bindings(Source("bindings.toml", BINDINGS + more))
    assert wrong == ()
    assert found is not None
    return found


def codes(more: str) -> list[str]:
    return [d.code.number for d in TARGET.remarks(TargetOptions(declarations=declared(more)))]


# The file -------------------------------------------------------------------------------------


def test_the_core_is_the_one_that_is_tested() -> None:
    source = Path(str(interceptor.__file__)).read_text(encoding="utf-8")
    emitted = text(NODE, "bindings.toml")
    assert core().text in source
    assert emitted.count(core().text) == 1
    assert emitted.index(core().text) < emitted.index("OPTIONS = ") < emitted.index(MARKER)


@pytest.mark.parametrize("node", [NODE, PAPER])
def test_core_and_options_need_two_modules_of_the_standard_library(node: Interception) -> None:
    head, _, rest = text(node, "bindings.toml").partition(MARKER)
    imports = [n for n in ast.walk(ast.parse(head)) if isinstance(n, ast.Import | ast.ImportFrom)]
    assert [getattr(n, "module", None) for n in imports] == [None, "dataclasses", "typing"]
    outer = [n for n in ast.parse(rest).body if isinstance(n, ast.Import | ast.ImportFrom)]
    names = {getattr(n, "module", None) or n.names[0].name for n in outer}
    assert {str(name).partition(".")[0] for name in names} <= {*sys.stdlib_module_names}


def test_durations_become_ticks_rounded_up_and_say_where_they_are_from() -> None:
    assert counted(NODE) == interceptor.Options(2, 3, 0, 0)
    assert counted(PAPER) == interceptor.Options(0, 0, 0, 0, event_driven=True, latching=True)
    assert "    hold=2,  # hold = 90 ms, at 50 ms a tick\n" in text(NODE, "b.toml")
    assert "    scan_timeout=0,  # no scan_timeout is declared\n" in text(NODE, "b.toml")


@given(options, st.lists(events, max_size=12))
def test_the_emitted_step_is_the_core(made: interceptor.Options, messages: list[Any]) -> None:
    module = MODULE
    state, mine = interceptor.initial(made), module.initial(made)
    for message in messages:
        same = getattr(module, type(message).__name__)
        values = [getattr(message, name) for name in message.__dataclass_fields__]
        state, output = interceptor.step(state, message, made)
        mine, own_output = module.step(mine, same(*values), made)
        assert own_output == output
        assert repr(mine) == repr(state)


MODULE = executed(text(NODE, "bindings.toml"), "interceptor")


# Refusals and remarks -------------------------------------------------------------------------


def test_without_a_table_the_one_to_paste_in_is_shown(fretc: Fretc) -> None:
    path = write("r.fret", "the robot shall always satisfy p")
    run = fretc(path, "--emit", "interceptor")
    assert run.status == 2
    assert run.err.startswith(
        "F323 there are no bindings, and so no interceptor\n"
        "  --> bindings.toml\n"
        "help: add this table to bindings.toml, with the topics of your robot:"
    )
    write("bindings.toml", BINDINGS)
    run = fretc(path, "--emit", "interceptor")
    assert run.status == 2
    assert run.err.startswith(
        "F323 the bindings declare no interceptor\n  --> bindings.toml:1:1\n   | [clock]\n"
    )
    pasted = run.err[run.err.index("[interceptor]") :]
    write("bindings.toml", f"{BINDINGS}\n{pasted}")
    assert fretc(path, "--emit", "interceptor").status == 0
    assert Path("build/interceptor.py").exists()


def test_one_file_is_for_all_requirements(fretc: Fretc) -> None:
    write("bindings.toml", f'{BINDINGS}\n{TABLE}period = "50 ms"\n')
    files = [write(f"r{i}.fret", "the robot shall always satisfy p") for i in (1, 2)]
    run = fretc(*files, "--emit", "interceptor", "-o", "out")
    assert (run.status, [p.name for p in Path("out").iterdir()]) == (0, ["interceptor.py"])
    assert run.err.count("F631 warning") == 2


def test_what_can_go_wrong_is_said() -> None:
    timer = f'{TABLE}period = "50 ms"\n'
    watched = f'{timer}stop_timeout = "1 s"\nscan = "/scan"\nscan_timeout = "1 s"\n'
    assume = '[assume]\nstands = "p"\nlatency = "0 s"\nbraking = "0 s"\nlost = 2\n'
    assert codes(f'{TABLE}form = "event"\n{assume}') == ["F632"]
    assert codes(timer) == ["F631", "F631"]
    assert codes(f'{timer}stop_timeout = "1 s"\n') == ["F631"]
    assert codes(watched) == []
    assert codes(watched + assume) == ["F630"]
    assert codes(f'{watched}hold = "250 ms"\n{assume}') == ["F630"]
    assert codes(f'{watched}hold = "251 ms"\n{assume}') == []
    assert codes(f"{watched}{assume.replace('lost = 2', 'lost = 0')}") == []
    (diagnostic,) = TARGET.remarks(TargetOptions(declarations=declared(watched + assume)))
    assert diagnostic.message == (
        "zero is held for 0 s for certain, but messages may be lost for 200 ms: a robot that was "
        "stopped may move between two requests"
    )
    assert diagnostic.help == "make `hold` longer than 250 ms"


def test_evidence_does_not_grow_stale_where_only_the_interceptor_changes() -> None:
    plain = bound(declared(""), ["p"])
    assert bound(declared(f'{TABLE}period = "50 ms"\n'), ["p"]) == plain
    assume = '[assume]\nstands = "p"\nlatency = "0 s"\nbraking = "0 s"\n'
    assert bound(declared(assume), ["p"]) == plain
    found, _ = read_bindings(Source("bindings.toml", BINDINGS.replace("x > 0", "x > 1")))
    assert found is not None
    assert bound(found, ["p"]) != plain


# The node -------------------------------------------------------------------------------------


@dataclass
class Ros:
    """What a node has asked ROS for."""

    hears: dict[str, tuple[str, Callable[[Any], None]]] = field(default_factory=dict)
    says: list[tuple[str, tuple[float, ...]]] = field(default_factory=list)
    timers: list[tuple[float, Callable[[], None]]] = field(default_factory=list)
    closed: list[str] = field(default_factory=list)
    story: Callable[["Ros"], None] = lambda ros: None
    """What happens until ROS, or a signal, ends the node."""
    publishers: Counter[str] = field(default_factory=lambda: Counter({"/stop": 1}))
    signalled: bool = True
    """Whether a signal ends it."""
    handlers: list[Callable[[int, object], None]] = field(default_factory=list)
    join: Callable[[], None] = lambda: None
    acknowledges: bool = True
    """Whether the middleware of ROS 2 knows what subscribers have got."""
    acknowledged: int = 0
    """How many messages they have for certain."""

    def interrupt(self) -> None:
        """A signal comes; the thread that hears it waits for the one that this is called in."""
        for handle in self.handlers:
            handle(2, None)


class Twist:
    def __init__(self, *six: float) -> None:
        vx, vy, vz, wx, wy, wz = six or (0.0,) * 6
        self.linear = SimpleNamespace(x=vx, y=vy, z=vz)
        self.angular = SimpleNamespace(x=wx, y=wy, z=wz)

    def six(self) -> tuple[float, ...]:
        return (*vars(self.linear).values(), *vars(self.angular).values())


class Bool:
    def __init__(self, data: bool) -> None:
        self.data = data


class LaserScan:
    pass


class Publisher:
    def __init__(self, ros: Ros, topic: str) -> None:
        self.ros, self.topic = ros, topic

    def publish(self, message: Twist) -> None:
        self.ros.says.append((self.topic, message.six()))

    def wait_for_all_acked(self, timeout: float) -> bool:
        assert timeout > 0
        if not self.ros.acknowledges:
            raise RuntimeError("unsupported")
        self.ros.acknowledged = len(self.ros.says)
        return True


def ros2(ros: Ros) -> dict[str, Any]:
    def subscribe(kind: type, topic: str, call: Callable[[Any], None], qos: object) -> Any:
        ros.hears[topic] = (kind.__name__, call)
        return SimpleNamespace(topic_name=topic)

    def spin(node: object) -> None:
        ros.story(ros)
        if ros.signalled:
            ros.interrupt()

    def shut_down() -> None:
        assert not ros.acknowledges or ros.acknowledged == len(ros.says), "a message may be lost"
        ros.closed.append("rclpy")

    node = SimpleNamespace(
        create_publisher=lambda kind, topic, depth: Publisher(ros, topic),
        create_subscription=subscribe,
        create_timer=lambda period, call, clock: ros.timers.append((period, call)),
        count_publishers=lambda topic: ros.publishers[topic],
    )
    return {
        "rclpy": SimpleNamespace(
            init=lambda args, signal_handler_options: None,
            create_node=lambda name: node,
            spin=spin,
            ok=lambda: not ros.closed,
            shutdown=shut_down,
        ),
        "rclpy.clock": SimpleNamespace(
            Clock=lambda clock_type: clock_type, ClockType=SimpleNamespace(STEADY_TIME="steady")
        ),
        "rclpy.duration": SimpleNamespace(Duration=lambda seconds: seconds),
        "rclpy.qos": SimpleNamespace(qos_profile_sensor_data="sensor"),
        "rclpy.signals": SimpleNamespace(SignalHandlerOptions=SimpleNamespace(NO=0)),
    }


def ros1(ros: Ros) -> dict[str, Any]:
    ends: list[Callable[[], None]] = []
    whys: list[Callable[[str], None]] = []

    def subscribe(
        topic: str,
        kind: type,
        call: Callable[[Any], None] | None = None,
        queue_size: int | None = None,
    ) -> Any:
        if call is not None:
            ros.hears[topic] = (kind.__name__, call)
        return SimpleNamespace(get_num_connections=lambda: ros.publishers[topic])

    def shut_down(reason: str) -> None:
        if not ros.closed:
            ros.closed.append(reason)
            for end in ends:
                end()
            for why in whys:
                why(reason)

    def spin() -> None:
        ros.story(ros)
        if ros.signalled:
            ros.interrupt()
        else:
            shut_down("new node registered with same name")

    def is_shutdown() -> bool:
        if len(ros.says) < 3:
            return False
        spin()
        return True

    return {
        "rosgraph": SimpleNamespace(get_master_uri=lambda: "http://master:11311"),
        "rospy": SimpleNamespace(
            core=SimpleNamespace(add_preshutdown_hook=whys.append),
            init_node=lambda name, argv, disable_signals: ros.join(),
            Publisher=lambda topic, kind, queue_size: Publisher(ros, topic),
            Subscriber=subscribe,
            on_shutdown=ends.append,
            signal_shutdown=shut_down,
            is_shutdown=is_shutdown,
            spin=spin,
        ),
    }


@contextmanager
def installed(ros: Ros, modules: dict[str, Any]) -> Iterator[None]:
    """As if ROS were here; no signal of this process is touched."""
    messages = {
        "geometry_msgs.msg": SimpleNamespace(Twist=Twist),
        "std_msgs.msg": SimpleNamespace(Bool=Bool),
        "sensor_msgs.msg": SimpleNamespace(LaserScan=LaserScan),
    }
    with pytest.MonkeyPatch.context() as patched:
        for name, content in (modules | messages).items():
            module = ModuleType(name)
            vars(module).update(vars(content))
            patched.setitem(sys.modules, name, module)
            parent = name.partition(".")[0]
            if parent not in modules:
                patched.setitem(sys.modules, parent, ModuleType(parent))
        patched.setattr("signal.signal", lambda number, handle: ros.handlers.append(handle))
        yield


FAST = (0.4, 0.1, 0.2, 0.3, 0.5, 0.6)
STILL = (0.0,) * 6


def run(node: Interception, ros: Ros, modules: dict[str, Any]) -> int:
    module = executed(text(node, "bindings.toml"), "interceptor")
    module.FLUSH = 0.0
    with installed(ros, modules):
        status: int = module.main(["interceptor.py"])
    return status


def test_the_node_for_ros_2_hears_and_speaks() -> None:
    def story(ros: Ros) -> None:
        hear = {topic: call for topic, (_, call) in ros.hears.items()}
        ((period, ring),) = ros.timers
        assert period == 0.05
        ring()
        hear["/stop"](Bool(False))
        hear["/cmd_vel"](Twist(*FAST))
        hear["/scan"](LaserScan())
        ring()
        hear["/cmd_vel"](Twist(0.4, 0.0, 0.0, 0.0, 0.0, nan))
        hear["/cmd_vel"](Twist(*FAST))
        hear["/stop"](Bool(True))
        hear["/cmd_vel"](Twist(inf, *FAST[1:]))
        hear["/cmd_vel"](Twist(*FAST))

    ros = Ros(story=story)
    assert run(NODE, ros, ros2(ros)) == 0
    assert {topic: kind for topic, (kind, _) in ros.hears.items()} == {
        "/stop": "Bool",
        "/cmd_vel": "Twist",
        "/scan": "LaserScan",
    }
    outputs = [STILL, FAST, FAST, STILL, FAST, STILL, STILL, STILL, STILL]
    assert ros.says == [("/wheels", one) for one in outputs]
    assert ros.closed == ["rclpy"]


def test_the_last_that_the_wheels_hear_is_zero_whatever_ends_the_node(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def story(ros: Ros) -> None:
        ros.hears["/stop"][1](Bool(False))
        ros.hears["/cmd_vel"][1](Twist(*FAST))
        raise ValueError("the middleware is gone")

    ros = Ros(story=story)
    assert run(NODE, ros, ros2(ros)) == 1
    assert ros.says[-2:] == [("/wheels", FAST), ("/wheels", STILL)]
    assert capsys.readouterr().err == "interceptor.py: ValueError: the middleware is gone\n"

    for acknowledges in (True, False):
        ros = Ros(acknowledges=acknowledges)
        assert run(NODE, ros, ros2(ros)) == 0
        assert ros.says == [("/wheels", STILL)]
        assert ros.closed == ["rclpy"]

    ros = Ros(signalled=False)
    assert run(NODE, ros, ros2(ros)) == 4
    assert ros.says == [("/wheels", STILL)]
    assert capsys.readouterr().err == "interceptor.py: ROS has ended it: it was shut down\n"


def test_the_end_waits_for_whoever_speaks_and_nobody_speaks_after_it() -> None:
    """The thread that ends the node needs the lock; no signal can take it from its holder."""
    module, outputs = executed(text(NODE, "bindings.toml"), "interceptor"), list[Any]()
    inside, go = Event(), Event()

    def publish(velocity: Any) -> None:
        inside.set()
        assert go.wait(5)
        outputs.append(velocity)

    gate = module.Gate(publish)
    module.FLUSH = 0.0
    ringing, closing = Thread(target=gate.ring), Thread(target=gate.close)
    ringing.start()
    assert inside.wait(5)
    closing.start()
    go.set()
    ringing.join(5)
    closing.join(5)
    gate.ring()
    gate.close()
    assert outputs == [module.ZERO, module.ZERO]


def test_of_two_safety_functions_none_moves_the_robot(capsys: pytest.CaptureFixture[str]) -> None:
    def story(ros: Ros) -> None:
        hear = {topic: call for topic, (_, call) in ros.hears.items()}
        ((_, ring),) = ros.timers
        hear["/stop"](Bool(False))
        hear["/cmd_vel"](Twist(*FAST))
        ros.publishers["/stop"] = 2
        ring()
        hear["/stop"](Bool(False))
        hear["/cmd_vel"](Twist(*FAST))
        ros.publishers["/stop"] = 1
        hear["/cmd_vel"](Twist(*FAST))
        hear["/stop"](Bool(False))
        hear["/cmd_vel"](Twist(*FAST))

    ros = Ros(story=story)
    node = Interception("/stop", "/cmd_vel", "/wheels", period=50 * MS)
    assert run(node, ros, ros2(ros)) == 0
    moving = [output == FAST for _, output in ros.says]
    assert moving == [True, *[False] * (len(moving) - 3), True, False]
    assert capsys.readouterr().err == (
        "interceptor.py: /stop has several publishers: the robot stands until one is left\n"
        "interceptor.py: /stop has one publisher again, which decides\n"
    )


@pytest.mark.slow
@given(options, st.lists(st.tuples(events, st.booleans()), max_size=20))
def test_while_there_are_two_safety_functions_nothing_but_zero_is_said(
    made: interceptor.Options, messages: list[tuple[Any, bool]]
) -> None:
    """And with one of them the gate is the core alone, from the state that it has come to."""
    module, outputs, count = executed(text(NODE, "bindings.toml"), "interceptor"), list[Any](), [1]
    module.OPTIONS = module.Options(*(getattr(made, n) for n in made.__dataclass_fields__))
    module.tell = lambda what: None
    gate = module.Gate(outputs.append, lambda: count[0])
    for message, alone in messages:
        count[0] = 1 if alone else 2
        values = [getattr(message, name) for name in message.__dataclass_fields__]
        same = getattr(module, type(message).__name__)(*values)
        state, output = module.step(gate.state, same, module.OPTIONS)
        outputs.clear()
        gate.take(same)
        if alone:
            assert (gate.state, outputs) == (state, [] if output is None else [output])
        else:
            assert gate.state.stop
            assert not any(map(any, outputs))


def test_the_papers_node_for_ros_1_has_no_timer() -> None:
    def story(ros: Ros) -> None:
        ros.hears["/cmd_vel"][1](Twist(*FAST))
        ros.hears["/stop"][1](Bool(True))
        ros.hears["/stop"][1](Bool(False))
        ros.hears["/cmd_vel"][1](Twist(*FAST))

    ros = Ros(story=story)
    assert run(PAPER, ros, ros1(ros)) == 0
    assert ros.says == [("/wheels", one) for one in (FAST, STILL, STILL)]
    assert sorted(ros.hears) == ["/cmd_vel", "/stop"]


def test_what_ends_the_node_of_ros_1_is_told_by_its_status(
    capsys: pytest.CaptureFixture[str],
) -> None:
    ros = Ros(signalled=False)
    assert run(PAPER, ros, ros1(ros)) == 4
    assert ros.says == [("/wheels", STILL)]
    message = "interceptor.py: ROS has ended it: new node registered with same name\n"
    assert capsys.readouterr().err == message

    def wait_for_a_master() -> None:
        ros.interrupt()
        over.wait()

    over = Event()
    ros = Ros(join=wait_for_a_master)
    assert run(PAPER, ros, ros1(ros)) == 3
    over.set()
    message = "interceptor.py: no ROS master has answered at http://master:11311\n"
    assert (ros.says, capsys.readouterr().err) == ([], message)


def test_the_timer_of_ros_1_is_steady_and_makes_up_for_nothing() -> None:
    slept: list[float] = []
    now = [10.0]

    def sleep(seconds: float) -> None:
        slept.append(round(seconds, 3))
        now[0] += seconds + (1.0 if len(slept) == 1 else 0.01)  # the first tick is a second late

    node = Interception("/stop", "/cmd_vel", "/wheels", period=50 * MS, ros=1)
    ros = Ros(story=lambda ros: ros.hears["/cmd_vel"][1](Twist(*FAST)))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("time.monotonic", lambda: now[0])
        patched.setattr("time.sleep", sleep)
        assert run(node, ros, ros1(ros)) == 0
    assert slept == [0.05, 0.0, 0.04, 0.0]  # the last is for the last zero to leave
    assert [one for _, one in ros.says] == [STILL, STILL, STILL, FAST, STILL]


def test_without_ros_it_says_so_and_help_needs_none(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(sys.modules, "rclpy", None)
        patched.setattr("signal.signal", lambda number, handle: None)
        assert MODULE.main(["interceptor.py"]) == 2
        assert capsys.readouterr().err.startswith("interceptor.py: it needs ROS 2 and its Python p")
        assert MODULE.main(["interceptor.py", "--help"]) == 0
    assert capsys.readouterr().out == (
        "usage: python interceptor.py [ROS ARGUMENTS]\n\n"
        "Hears /stop (Bool), /cmd_vel (Twist), /scan (LaserScan).\n"
        "Every 50 ms, on each command and at once on a request to stop\n"
        "it says the last command on /wheels,\nor zero where the robot must stand.\n\n"
        "exit status: 0 ended by SIGINT or SIGTERM, 1 a fault, 2 ROS is not installed,\n"
        "4 ROS has ended it\n"
    )
