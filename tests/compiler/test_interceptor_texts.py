# ruff: noqa: E501, RUF001
"""Interceptors that fly otherwise than what is explored of them, or run code while they are looked at.

None of them may be proved, or executed before it is shown to be pure.
"""

import builtins
from collections.abc import Iterator
from pathlib import Path

import pytest

from compiler.contracts import contracts
from compiler.gate import Gate, Heard, NotAnInterceptorError, Settings
from compiler.purity import otherwise
from compiler.targets import interceptor
from compiler.verification import Proved
from fretish.declarations import Interception
from monitors.interceptor import Options

DECLARED = Interception(
    "/gwendolen_control", "/cmd_vel", "/cmd_vel_filtered", None, 50_000_000, 200_000_000
)
BASE = interceptor.text(DECLARED, "bindings.toml")
SETTINGS = Settings(hold=4)
OPTIONS = Options(4, 0, 0, 0)
BAD = """
def step(state, heard, options):
    match heard:
        case CommandHeard(command):
            return state, command
        case _:
            return state, state.command
"""
BODY = '"""Each step computes from its arguments alone."""'


def sub(old: str, new: str, text: str = BASE) -> str:
    assert text.count(old) == 1, (old, text.count(old))
    return text.replace(old, new)


def end(more: str) -> str:
    return sub('if __name__ == "__main__":', more + '\n\nif __name__ == "__main__":')


def ind(text: str) -> str:
    return text.replace("\n", "\n    ")


# name -> text; RUN: executes code while being looked at (writes the file PWNED)
P = '__import__("pathlib").Path("PWNED").touch()'
TEXTS = {
    # what runs at once
    "RUN default of a field": sub("    hold: int\n", f"    hold: int = {P} or 0\n"),
    "RUN annotation without the future import": sub(
        "from __future__ import annotations\n", ""
    ).replace("    requested: bool\n", f"    requested: {P}\n"),
    "RUN keyword of a class": sub(
        "class Velocity(NamedTuple):", f"class Velocity(NamedTuple, metaclass={P} or type):"
    ),
    "RUN annotation of a function": sub("from __future__ import annotations\n", "").replace(
        "def initial(options: Options)", f"def initial(options: {P})"
    ),
    "RUN returns of a function": sub("from __future__ import annotations\n", "").replace(
        "timeout: int) -> bool:", f"timeout: int) -> {P}:"
    ),
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
        "step.__code__ = (lambda state, heard, options: (state, state.command)).__code__"
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
    "pattern of a velocity": sub(
        "        case CommandHeard(command):\n",
        "        case CommandHeard(Velocity() as command):\n            return state, command\n"
        "        case CommandHeard(command):\n",
    ),
    "pattern of an attribute": sub(
        "        case CommandHeard(command):\n",
        "        case CommandHeard(Velocity(vx=0.1) as command):\n            return state, command\n"
        "        case CommandHeard(command):\n",
    ),
    "identity by a tuple": sub(
        "        case CommandHeard(command):\n",
        "        case CommandHeard(command) if (command,) != (command,) or (heard,) != (heard,):\n            return state, command\n"
        "        case CommandHeard(command) if state.stop and not (command in (state.command, command)):\n            return state, command\n"
        "        case CommandHeard(command):\n",
    ),
    "identity by states": sub(
        "        case CommandHeard(command):\n",
        "        case CommandHeard(command) if state.stop and state.held == 0 and heard != CommandHeard(state.command):\n            return state, command\n"
        "        case CommandHeard(command):\n",
    ),
    "str of a command": sub(
        "        case CommandHeard(command):\n",
        "        case CommandHeard(command) if 'Vel' in '%s' % (command,):\n            return state, command\n"
        "        case CommandHeard(command):\n",
    ),
}


@pytest.fixture(autouse=True)
def _there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The built-in functions are as they were, whatever a text does."""
    monkeypatch.chdir(tmp_path)
    kept = builtins.min, builtins.max
    yield
    builtins.min, builtins.max = kept


@pytest.mark.parametrize("name", TEXTS)
def test_the_loop_does_not_take_it(name: str) -> None:
    taken = True
    try:
        gate = Gate(TEXTS[name], SETTINGS)
        states = [gate.initial]
        for state in states:  # grows while it is read
            found = (gate.hear(state, heard)[0] for heard in Heard)
            states += [after for after in dict.fromkeys(found) if after not in states]
    except NotAnInterceptorError:
        taken = False
    assert not Path("PWNED").exists(), "it was executed"
    assert not taken, "the text is explored as if it were all"


@pytest.mark.parametrize("name", TEXTS)
def test_the_contracts_are_not_proved_of_it(name: str) -> None:
    found = contracts(TEXTS[name], OPTIONS)
    assert not Path("PWNED").exists(), "it was executed"
    assert not all(isinstance(one.result, Proved) for one in found)


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
