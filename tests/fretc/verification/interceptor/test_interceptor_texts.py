# ruff: noqa: E501, RUF001
"""Interceptors that fly otherwise than what is explored of them, or run code while they are looked at.

None of them may be proved, or executed before a proof that it is pure.
"""

import builtins
import symtable
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from compiler.logic.claims import ClaimResult
from compiler.targets.python import interceptor
from fretc.verification.engines.crosshair import contract_texts
from fretc.verification.interceptor.contracts import contracts
from fretc.verification.interceptor.file import PureCore, core, head, otherwise
from fretc.verification.interceptor.machine import Event, InterceptorMachine, NotAnInterceptorError
from fretish.bindings.declarations import Interception, InterceptorForm
from monitors.interceptor import Options
from tests.each import each
from tests.effort import examples, some
from tests.loops import edited, interceptor_options, with_match

DECLARED = Interception(
    "/gwendolen_control", "/cmd_vel", "/cmd_vel_filtered", None, 50_000_000, 200_000_000
)
BASE = with_match(interceptor.text(DECLARED, "bindings.toml"))
SETTINGS = interceptor_options(hold=4)
OPTIONS = Options(4, 0, 0, 0)
BAD = """
def step(state, event, options):
    match event:
        case CommandHeard(command):
            return state, command
        case _:
            return state, state.command
"""
COMMAND = "        case CommandHeard(command):\n"


def sub(old: str, new: str, text: str = BASE) -> str:
    return edited(text, old, new)


def end(more: str) -> str:
    return sub('if __name__ == "__main__":', more + '\n\nif __name__ == "__main__":')


def heard(*cases: str) -> str:
    """Further cases before that of a command; they pass it on as it is."""
    passed = "            return state, command\n"
    return sub(COMMAND, "".join(f"        case {each}:\n{passed}" for each in cases) + COMMAND)


def ind(text: str) -> str:
    return text.replace("\n", "\n    ")


# name -> text; RUN: executes code while being looked at (writes the file PWNED)
P = '__import__("pathlib").Path("PWNED").touch()'
TEXTS = {
    # what runs at once
    "RUN default of a field": sub("    hold: int\n", f"    hold: int = {P} or 0\n"),
    "RUN annotation of a field": sub("    requested: bool\n", f"    requested: {P}\n"),
    "RUN keyword of a class": sub(
        "class Velocity(NamedTuple):", f"class Velocity(NamedTuple, metaclass={P} or type):"
    ),
    "RUN annotation of a function": sub(
        "def initial(options: Options)", f"def initial(options: {P})"
    ),
    "RUN returns of a function": sub("timeout: int) -> bool:", f"timeout: int) -> {P}:"),
    "RUN sys of dataclasses": sub(
        "from typing import NamedTuple\n",
        "from typing import NamedTuple\nfrom dataclasses import sys\n",
    ).replace(
        "    return timeout > 0 and age >= timeout",
        "    x = sys.modules.get('pathlib').Path('PWNED').touch()\n    return timeout > 0 and age >= timeout",
    ),
    # other definitions than those explored
    "step again below if": end(f"if True:\n    {ind(BAD)}"),
    "step again below try": end(f"try:\n    {ind(BAD)}\nfinally:\n    pass"),
    "step again below with": end(
        f"import contextlib\nwith contextlib.nullcontext():\n    {ind(BAD)}"
    ),
    "step imported below if": end("if True:\n    from os import path as step"),
    "star import": end("from overrides import *"),
    "globals()": end("globals()['step'] = lambda s, h, o: (s, s.command)"),
    "locals()": end("locals()['step'] = lambda s, h, o: (s, s.command)"),
    "locals().update": end("locals().update(step=lambda s, h, o: (s, s.command))"),
    "setattr of the module": end(
        "setattr(sys.modules[__name__], 'step', lambda s, h, o: (s, s.command))"
    ),
    "getattr of __globals__": end(
        "getattr(step, '__glob' + 'als__')['step'] = lambda s, h, o: (s, s.command)"
    ),
    "frame": end("sys._getframe().f_globals['step'] = lambda s, h, o: (s, s.command)"),
    "exec": end("exec('def step(s, h, o): return s, s.command')"),
    "code of step": end(
        "step.__code__ = (lambda state, event, options: (state, state.command)).__code__"
    ),
    "code of step by setattr": end(
        "setattr(step, '__code__', (lambda s, h, o: (s, s.command)).__code__)"
    ),
    "defaults of Velocity": end(
        "type.__setattr__(State, '__eq__', None); Velocity.__new__.__defaults__ = (1.0,) * 6"
    ),
    "own min in the node": end("def min(*_):\n    return 0"),
    "own max in the node": end("max = lambda *_: 10**6"),
    "builtins.min": end("import builtins\nbuiltins.max = lambda *_: 0"),
    "own dataclass": sub(
        "from typing import NamedTuple\n",
        "from typing import NamedTuple\nfrom strange import dataclass\n",
    ),
    "own dataclass, a function": sub(
        "from typing import NamedTuple\n",
        "from typing import NamedTuple\ndef dataclass(**k):\n    return lambda c: c\n",
    ),
    "own NamedTuple": sub(
        "from typing import NamedTuple\n",
        "from typing import NamedTuple\nclass NamedTuple:\n    pass\n",
    ),
    "own replace under if": sub(
        "ZERO = Velocity()\n", "ZERO = Velocity()\nif True:\n    from copy import copy as replace\n"
    ),
    "loop of the module": end("for step in [lambda s, h, o: (s, s.command)]:\n    pass"),
    "walrus of the module": end("print((step := lambda s, h, o: (s, s.command)))"),
    "decorator of a class in the node": end(
        "class X:\n    locals()['a'] = globals().update(step=None)"
    ),
    "unicode name": end("ſtep = lambda s, h, o: (s, s.command)"),  # NFKC: it IS `step`
    "unicode def": end("def ſtep(s, h, o):\n    return s, s.command"),
    # the source is another for Python
    "coding cookie": "# -*- coding: raw_unicode_escape -*-\n"
    + end("# \\u000astep = lambda s, h, o: (s, s.command)"),
    # what looks into a command
    "pattern of a velocity": heard("CommandHeard(Velocity() as command)"),
    "pattern of an attribute": heard("CommandHeard(Velocity(vx=0.1) as command)"),
    "identity by a tuple": heard(
        "CommandHeard(command) if (command,) != (command,) or (event,) != (event,)",
        "CommandHeard(command) if state.stop and not (command in (state.command, command))",
    ),
    "identity by states": heard(
        "CommandHeard(command) if state.stop and state.held == 0 and event != CommandHeard(state.command)"
    ),
    "str of a command": heard("CommandHeard(command) if 'Vel' in '%s' % (command,)"),
}


@pytest.fixture(autouse=True)
def _there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The built-in functions are as they were, whatever a text does."""
    monkeypatch.chdir(tmp_path)
    kept = builtins.min, builtins.max
    yield
    builtins.min, builtins.max = kept


@pytest.mark.slow
@each("name", TEXTS)
def test_the_loop_does_not_take_it(name: str) -> None:
    taken = True
    try:
        machine = InterceptorMachine(TEXTS[name], SETTINGS)
        states = [machine.initial]
        for state in states:  # grows while it is read
            reached = (machine.step(state, event)[0] for event in Event)
            states += [after for after in dict.fromkeys(reached) if after not in states]
    except NotAnInterceptorError:
        taken = False
    assert not Path("PWNED").exists(), "it was executed"
    assert not taken, "the text is explored as if it were all"


@pytest.mark.slow
@each("name", TEXTS)
def test_the_contracts_are_not_proved_of_it(name: str) -> None:
    proofs = contracts(TEXTS[name], OPTIONS)
    assert not Path("PWNED").exists(), "it was executed"
    assert not all(one.result is ClaimResult.PROVED for one in proofs)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("PERIOD = 0.05", "PERIOD = 0.05\nPERIOD *= 100"),
        ("PERIOD = 0.05", "PERIOD: float = 5.0"),
        ("PERIOD = 0.05", "if True:\n    PERIOD = 5.0"),
        ("OPTIONS = Options(\n    hold=4,", "OPTIONS: Options = Options(\n    hold=0,"),
        ("PERIOD = 0.05", "PERIOD = 0.05\nif True:\n    OPTIONS = Options(0, 0, 0, 0)"),
    ],
)
def test_a_file_with_other_options_or_another_period_is_told(old: str, new: str) -> None:
    assert otherwise(sub(old, new), DECLARED) is not None


# One module: what core and node share ---------------------------------------------------------

NODES = [
    interceptor.text(
        Interception("/stop", "/cmd", "/out", scan, 50_000_000, form=form, ros=ros), "bindings.toml"
    )
    for scan in (None, "/scan")
    for form in InterceptorForm
    for ros in (1, 2)
]


def bound_by_node(text: str) -> set[str]:
    """The global names that Python's own symbol tables give to the part below the line."""
    table = symtable.symtable(text.partition(interceptor.MARKER)[2], "node", "exec")
    return {s.get_name() for s in table.get_symbols() if s.is_assigned() or s.is_imported()}


def with_helper(name: str, text: str = BASE) -> str:
    """A core whose `halted` asks a helper of that name, and is right as long as it is its own."""
    helper = f"def {name}(stop: bool) -> bool:\n    return not stop\n\n\n"
    changed = sub(
        "        state.stop\n        or", f"        not {name}(state.stop)\n        or", text
    )
    return sub("def halted(", f"{helper}def halted(", changed)


def all_proved(text: str) -> bool:
    return all(one.result is ClaimResult.PROVED for one in contracts(text, OPTIONS))


def test_a_helper_with_a_name_of_its_own_changes_nothing() -> None:
    assert all_proved(with_helper("asks"))


NAMES = sorted({*set().union(*map(bound_by_node, NODES)), *dir(builtins)} - {"OPTIONS"})


@pytest.mark.slow
@each("name", some(NAMES, 5))
def test_a_core_binds_no_name_that_its_node_binds_or_calls(name: str) -> None:
    """The node below would have it mean something else while it flies, or would call the core's."""
    assert isinstance(head(with_helper(name)), str)


def test_the_names_of_nodes_are_those_that_a_core_is_tempted_by() -> None:
    names = set().union(*map(bound_by_node, NODES))
    assert {"isfinite", "twist", "velocity", "main", "Gate", "Node", "PERIOD", "sys"} <= names


@pytest.mark.parametrize("name", ["isfinite", "twist", "velocity", "Node", "all", "print"])
def test_neither_engine_takes_a_core_that_shadows_its_node(name: str) -> None:
    text = with_helper(name)
    assert not any(one.result is ClaimResult.PROVED for one in contracts(text, OPTIONS))
    with pytest.raises(NotAnInterceptorError):
        InterceptorMachine(text, SETTINGS)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("    wz: float = 0.0\n", "    wz: float = 0.0\n    extra: float = 0.0\n"),
        ("    wz: float = 0.0\n", ""),
        ("    wz: float = 0.0\n", "    wz: float = 1.0\n"),
        ("    wz: float = 0.0\n", "    wz: int = 0\n"),
        (
            "    vx: float = 0.0\n    vy: float = 0.0\n",
            "    vy: float = 0.0\n    vx: float = 0.0\n",
        ),
        ("class Velocity(NamedTuple):", "@dataclass(frozen=True)\nclass Velocity:"),
    ],
)
def test_a_velocity_has_its_six_numbers_and_no_others(old: str, new: str) -> None:
    """The node makes one of six numbers and takes it apart by their places."""
    text = sub(old, new)
    assert isinstance(head(text), str)
    assert not any(one.result is ClaimResult.PROVED for one in contracts(text, OPTIONS))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("velocity[:3]", "velocity[:2]"),
        ("node.create_timer(PERIOD", "node.create_timer(100.0"),
        ("PERIOD = 0.05", "PERIOD = 5.0"),
        ('OUTPUT = "/cmd_vel_filtered"', 'OUTPUT = "/cmd_vel"'),
        ("Twist, OUTPUT, 10)", "Twist, OUTPUT, 0)"),
        ("gate.hear_stop, 10)", "gate.hear_scan, 10)"),
        ("self._publish(ZERO)", "self._publish(OPTIONS)"),
        ("import time\n", ""),
        ("class Gate:\n", "class Gate:\n    hear_stop = None\n"),
    ],
)
def test_a_node_that_differs_in_anything_is_not_the_one_that_is_declared(
    old: str, new: str
) -> None:
    deviation = otherwise(sub(old, new), DECLARED)
    assert (
        deviation
        == "its node is not the one that fretc generates for these bindings: emit it again"
    )


@pytest.mark.slow
def test_the_core_and_comments_may_differ() -> None:
    assert otherwise(interceptor.text(DECLARED, "bindings.toml"), DECLARED) is None
    assert otherwise(with_helper("asks"), DECLARED) is None
    assert otherwise(sub("import time\n", "import time  # for the end\n"), DECLARED) is None
    for ros in (1, 2):  # packages have the node of their own ROS
        assert (
            otherwise(interceptor.text(DECLARED, "bindings.toml"), replace(DECLARED, ros=ros))
            is None
        )
    assert otherwise(BASE, replace(DECLARED, stop="/halt")) is not None


# The language of a core -----------------------------------------------------------------------

SCAN = "    return replace(state, scan_age=0), None\n"
OUTSIDE = (
    "min(0, 1, key='{0.real}'.format)", "max(state.held, 1, key=halted)",
    "max(state.held, 1, default=0)", "max(state.held)", "'{0.__class__}'.format", "(0).real",
    "0 .bit_length", "(1 + 1).real", "halted(state, options).real", "state.held.real",
    "state.held.bit_length", "state.command.count", "state.undeclared", "halted", "Velocity",
    "replace", "max", "len", "OPTIONS", "options.__class__",
    "step(state=state, event=0, options=options)", "replace(state, **options)",
    "replace(*options)", "replace()", "replace(state, _held=0)", "Velocity(*state)",
    "Velocity(_x=0)", "print(state)", "isfinite(0)", "bool(state.command)", "state.held(0)",
    "(lambda: 0)()", "lambda: 0", "[0]", "{0}", "{0: 0}", "(*options, 0)", "[0 for _ in state]",
    "(0 for _ in state)", "(here := 0)", "f'{state}'", "'text'", "b'text'", "...", "1j",
    "1e999", "state.held * 2", "state.held ** 2", "state.held % 2", "state.held // 2",
    "state.held @ 2", "state.held << 2", "state.held | 2", "state.held & 2", "state.held ^ 2",
    "~state.held", "+state.held", "state[0]", "state is options", "state is not options",
    "state.held in (0, 1)", "state.held not in (0, 1)", "(yield state)", "(yield from state)",
)  # fmt: skip
"""Expressions that are not of the language, each for one reason."""
PLACES = (
    "{0}", "replace(state, scan_age={0})", "0 if {0} else 1", "{0} if state.stop else 0",
    "not {0}", "-{0}", "state.stop and {0}", "({0}) == 0", "0 < 1 < ({0})", "({0}) + 1",
    "1 - ({0})", "min(0, {0})", "expired({0}, 1)", "(0, {0})", "Velocity({0})",
    "Velocity(vx={0})", "ScanHeard({0})",
)  # fmt: skip
STATEMENTS = (
    "    return {0}, None\n",
    "    found = {0}\n    return state, None\n",
    "    found: int = {0}\n    return state, None\n",
    "    if {0}:\n        return state, None\n    return state, None\n",
    "    match {0}:\n        case 0:\n            pass\n    return state, None\n",
    "    match state:\n        case State() if {0}:\n            pass\n    return state, None\n",
    "    {0}\n    return state, None\n",
    "    return (lambda: ({0}))(), None\n",
    "    for found in ({0}):\n        pass\n    return state, None\n",
    "    while {0}:\n        pass\n    return state, None\n",
    "    with {0}:\n        pass\n    return state, None\n",
    "    assert {0}\n    return state, None\n",
    "    raise {0}\n",
    "    del state\n    return {0}, None\n",
)


@pytest.mark.slow
@given(
    st.sampled_from(OUTSIDE),
    st.lists(st.sampled_from(PLACES), max_size=3),
    st.sampled_from(STATEMENTS),
)
@examples(25)
def test_what_is_not_of_the_language_is_refused_and_not_executed(
    outside: str, places: list[str], statement: str
) -> None:
    inner = f"({outside})"
    for place in places:
        inner = f"({place.format(inner)})"
    text = sub(SCAN, statement.format(inner))
    assume(_is_python(text))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fretc.verification.interceptor.file.executed", _never)
        assert isinstance(core(text), str), inner


@pytest.mark.slow
@each("outside", OUTSIDE)
def test_each_expression_is_outside_by_itself(outside: str) -> None:
    assert isinstance(head(sub(SCAN, f"    return ({outside}), None\n")), str)


def _is_python(text: str) -> bool:
    try:
        compile(text, "core", "exec")
    except SyntaxError:
        return False
    return True


def _never(*_: object) -> None:
    raise AssertionError("it was executed")


@pytest.mark.slow
@each("place", PLACES[1:])
def test_the_places_themselves_are_of_the_language(place: str) -> None:
    assert isinstance(head(sub(SCAN, f"    return ({place.format('0')}), None\n")), PureCore)


@pytest.mark.slow
@each(
    "annotation",
    [
        "print()", "'print()'", "Annotated[int, print()]", "list[int]", "state.held",
        "tuple[int, print()]", "[int]", "int if state else int", "lambda: int", "(int := bool)",
        "Literal[1]", "int & bool", "ClassVar", "builtins",
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("    hold: int\n", "    hold: {0}\n"),
        ("    requested: bool\n", "    requested: {0}\n"),
        ("def hear_scan(state: State, ", "def hear_scan(state: {0}, "),
        ("timeout: int) -> bool:", "timeout: int) -> {0}:"),
        (SCAN, "    found: {0} = 0\n" + SCAN),
    ],
)
def test_an_annotation_names_types_and_does_nothing(annotation: str, old: str, new: str) -> None:
    """CrossHair evaluates annotations."""
    assert isinstance(head(sub(old, new.format(annotation))), str)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("class State:", "inv: print()"),
        ("def initial(", "pre: print()"),
        ("def initial(", "post:\n        print()"),
        ("def initial(", ":raises: print()"),
        ("def initial(", "post[state]: print()"),
        ("def initial(", "a\\x85post: print()"),
        ("class ScanHeard:", "\\x69nv: print()"),
    ],
)
def test_a_contract_that_is_not_of_fretc_is_seen(name: str, line: str) -> None:
    """CrossHair executes it: of classes and of functions, wherever it finds a line to begin."""
    before, _, after = BASE.partition(name)
    quoted = after.partition('"""')
    changed = f'{before}{name}{quoted[0]}"""{line}\n\n    {quoted[2]}'
    assert isinstance(head(changed), PureCore), "it is pure all the same"
    assert contract_texts(changed) != contract_texts(BASE)
