"""An interceptor's text as a machine that can be put into any state and stepped.

Only its step is executed, with what that calls: no input, no output, no node. The step must be a
function of its arguments, which is read off its tree first; and it must not look into velocities,
so that one opaque command stands for all. Source of that reduction: Wolper, Expressing interesting
properties of programs in propositional temporal logic, POPL 1986 (data independence).
"""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from enum import Enum
from types import ModuleType
from typing import Any, NoReturn


class NotAnInterceptorError(Exception):
    """The text cannot be explored as an interceptor; it says why."""


class Heard(Enum):
    """What an interceptor can hear, as a model tells it apart."""

    STOP = "`true` is heard"
    RELEASE = "`false` is heard"
    MOVE = "a command to move is heard"
    STAND = "a command to stand is heard"
    SCAN = "a scan is heard"
    RING = "the timer rings"


State = tuple[int | bool, ...]
"""The fields of an interceptor's state; of the command whether it moves."""

Said = bool | None
"""Whether what is published moves the wheels; None: nothing is published."""


class Opaque:
    """A velocity that moves: whoever looks into it is told that nobody may."""

    __slots__ = ()

    def _refused(self, *_: object) -> NoReturn:
        raise NotAnInterceptorError("its step looks into a velocity")

    __eq__ = __lt__ = __bool__ = __iter__ = __getitem__ = __len__ = _refused
    __getattr__ = __add__ = __mul__ = __neg__ = __ne__ = __le__ = _refused
    __gt__ = __ge__ = __contains__ = __float__ = __abs__ = _refused
    __hash__ = object.__hash__


MOVING = Opaque()
_NEEDED = (
    "ZERO Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial halted step"
).split()
_BUILTINS = frozenset("abs all any bool int len max min not tuple True False None".split())


@dataclass(frozen=True, slots=True)
class Settings:
    """The options of an interceptor by name, in ticks of its timer."""

    hold: int = 0
    stop_timeout: int = 0
    scan_timeout: int = 0
    command_timeout: int = 0
    event_driven: bool = False
    latching: bool = False


class Gate:
    """The step of an interceptor's text, over encoded states, each computed once."""

    def __init__(self, text: str, settings: Settings, most: int = 10**6) -> None:
        """Raises NotAnInterceptorError where the text is none that can be explored.

        Args:
            text: with the step.
            settings: its options.
            most: states; where there are more, NotAnInterceptorError is raised, too.
        """
        self._most = most
        self._module = module = _loaded(text)
        named = {field.name: getattr(settings, field.name) for field in fields(settings)}
        self._options = module.Options(**named)
        self._deaf = module.Options(**{**named, "scan_timeout": 0, "command_timeout": 0})
        self._fields = tuple(field.name for field in fields(module.State))
        self._events = {
            Heard.STOP: module.StopHeard(True),
            Heard.RELEASE: module.StopHeard(False),
            Heard.MOVE: module.CommandHeard(MOVING),
            Heard.STAND: module.CommandHeard(module.ZERO),
            Heard.SCAN: module.ScanHeard(),
            Heard.RING: module.TimerRang(),
        }
        self._known: dict[tuple[State, Heard], tuple[State, Said]] = {}
        self._objects: dict[State, Any] = {}
        self._stopping: dict[State, bool] = {}
        self.initial = self._encoded(self._called(module.initial, self._options))

    def hear(self, state: State, heard: Heard) -> tuple[State, Said]:
        """The state after it, and what is published."""
        found = self._known.get((state, heard))
        if found is None:
            event = self._events[heard]
            told = self._called(self._module.step, self._objects[state], event, self._options)
            if not (isinstance(told, tuple) and len(told) == 2):
                raise NotAnInterceptorError("its step gives no pair")
            found = self._known[state, heard] = self._encoded(told[0]), self._said(told[1])
        return found

    def stopping(self, state: State) -> bool:
        """Whether it is halted, and not by the silence of a sensor or of the planner."""
        found = self._stopping.get(state)
        if found is None:
            told = self._called(self._module.halted, self._objects[state], self._deaf)
            found = self._stopping[state] = bool(told)
        return found

    def halts(self, state: Any) -> bool:
        """`halted`, of a state as the text has it."""
        return bool(self._module.halted(state, self._options))

    def fresh(self) -> Any:
        """The state at first as the text has it, for a replay."""
        return self._module.initial(self._options)

    def replayed(self, state: Any, heard: Heard) -> tuple[Any, Said]:
        """One step of the text itself, nothing encoded and nothing remembered."""
        after, said = self._module.step(state, self._events[heard], self._options)
        return after, self._said(said)

    def _called(self, function: Any, *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except NotAnInterceptorError:
            raise
        except Exception as error:
            why = f"{function.__name__} fails: {type(error).__name__}: {error}"
            raise NotAnInterceptorError(why) from None

    def _encoded(self, state: Any) -> State:
        if type(state) is not self._module.State:
            raise NotAnInterceptorError("its step gives no State")
        values = {name: getattr(state, name) for name in self._fields}
        moves = self._said(values["command"])
        if moves is None or not all(
            isinstance(value, int) for name, value in values.items() if name != "command"
        ):
            raise NotAnInterceptorError("its State holds something else than it declares")
        values["command"] = moves
        encoded = tuple(values.values())
        self._objects.setdefault(encoded, state)
        if len(self._objects) > self._most:
            raise NotAnInterceptorError(f"its State takes more than {self._most} values")
        return encoded

    def _said(self, velocity: Any) -> Said:
        if velocity is None:
            return None
        if velocity is MOVING:
            return True
        if type(velocity) is self._module.Velocity and not any(velocity):
            return False
        raise NotAnInterceptorError("it makes a velocity that it has not heard")


# The text -------------------------------------------------------------------------------------


def _loaded(text: str) -> Any:
    """What the step needs of the text, executed."""
    try:
        body = ast.parse(text).body
    except (SyntaxError, ValueError, RecursionError) as error:
        raise NotAnInterceptorError(f"it is no Python: {error}") from None
    kept = _needed(body)
    module = ModuleType("_fretc_interceptor")
    code = compile(ast.Module(list(kept), []), "<interceptor>", "exec")
    # Dataclasses look up their module by name while the text is being executed.
    sys.modules[module.__name__] = module
    try:
        exec(code, module.__dict__)
    except Exception as error:
        raise NotAnInterceptorError(f"it cannot be executed: {error}") from None
    finally:
        del sys.modules[module.__name__]
    return module


def _needed(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """The imports, and the definitions that the step leads to, in their order."""
    statements = list(body)
    defined: dict[str, list[ast.stmt]] = {}
    for statement in statements:
        for name in _bound(statement):
            defined.setdefault(name, []).append(statement)
    missing = [name for name in _NEEDED if name not in defined]
    if missing:
        raise NotAnInterceptorError(f"it defines no `{missing[0]}`")
    used, waiting = set(_NEEDED), list(_NEEDED)
    while waiting:
        name = waiting.pop()
        if len(defined[name]) > 1:
            raise NotAnInterceptorError(f"it defines `{name}` twice")
        found = _check(defined[name][0], defined)
        waiting += found - used
        used |= found
    for statement in statements:
        if _is_import(statement) or not used.isdisjoint(_bound(statement)):
            yield statement


def _is_import(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.ImportFrom) and statement.module in (
        "__future__",
        "dataclasses",
        "typing",
    )


def _bound(statement: ast.stmt) -> set[str]:
    """The names that a statement at the top of the text gives a value, wherever in it.

    What is bound within a function is its own; a `global` in one is a binding too.
    """
    match statement:
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
            inner = (node for node in ast.walk(statement) if isinstance(node, ast.Global))
            return {name, *(known for node in inner for known in node.names)}
        case ast.ImportFrom(names=aliases) | ast.Import(names=aliases):
            return {alias.asname or alias.name for alias in aliases}
        case _:
            return {
                node.id
                for node in ast.walk(statement)
                if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load)
            }


def _check(node: ast.stmt, defined: Mapping[str, list[ast.stmt]]) -> set[str]:
    """The definitions that it uses; it does nothing but compute."""
    match node:
        case ast.FunctionDef():
            return _check_function(node, defined)
        case ast.ClassDef():
            return _check_class(node)
        case ast.Assign([ast.Name("ZERO")], ast.Call(ast.Name("Velocity"), [], [])):
            return set()
        case ast.ImportFrom(module="dataclasses" | "typing"):
            return set()
        case _:
            raise NotAnInterceptorError(f"its step depends on `{_line(node)}`")


def _check_class(node: ast.ClassDef) -> set[str]:
    """Fields and nothing else: a record."""
    records = all(
        isinstance(part, ast.AnnAssign)
        or (isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant))
        for part in node.body
    )
    bases = [ast.unparse(base) for base in node.bases]
    decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
    plain = bases in ([], ["NamedTuple"]) and set(decorators) <= {
        "dataclass(frozen=True, slots=True)"
    }
    if not (records and plain):
        raise NotAnInterceptorError(f"`{node.name}` is no plain record")
    return set()


_PURE: tuple[type[ast.AST], ...] = (
    *(ast.Return, ast.Assign, ast.AnnAssign, ast.If, ast.Expr, ast.Pass),
    *(ast.Match, ast.match_case, ast.MatchClass, ast.MatchAs, ast.MatchValue, ast.MatchOr),
    *(ast.BoolOp, ast.BinOp, ast.UnaryOp, ast.Compare, ast.IfExp, ast.Call, ast.keyword),
    *(ast.Attribute, ast.Constant, ast.Name, ast.Tuple, ast.Subscript),
    *(ast.boolop, ast.operator, ast.unaryop, ast.cmpop, ast.expr_context),
)
_IDENTITY = (ast.Is, ast.IsNot)
"""They tell apart what one encoded state stands for."""


def _check_function(node: ast.FunctionDef, defined: Mapping[str, list[ast.stmt]]) -> set[str]:
    """It reads its arguments and what is defined once, and changes nothing."""
    if node.decorator_list or node.args.defaults or node.args.kw_defaults:
        raise NotAnInterceptorError(f"`{node.name}` has decorators or defaults")
    found: set[str] = set()
    own = {argument.arg for argument in node.args.args}
    own |= {inner.name for inner in ast.walk(node) if isinstance(inner, ast.MatchAs) and inner.name}
    inside = [inner for statement in node.body for inner in ast.walk(statement)]
    own |= {n.id for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    for inner in inside:
        if not isinstance(inner, _PURE) or isinstance(inner, _IDENTITY):
            raise NotAnInterceptorError(f"`{node.name}` may do more than compute: `{_line(inner)}`")
        if isinstance(inner, ast.Attribute | ast.Subscript) and not isinstance(inner.ctx, ast.Load):
            raise NotAnInterceptorError(f"`{node.name}` changes `{_line(inner)}`")
        if isinstance(inner, ast.Attribute) and inner.attr.startswith("_"):
            raise NotAnInterceptorError(f"`{node.name}` uses `{_line(inner)}`")
        if isinstance(inner, ast.Name) and inner.id not in own:
            found |= _global(node, inner.id, defined)
    return found


def _global(node: ast.FunctionDef, name: str, defined: Mapping[str, list[ast.stmt]]) -> set[str]:
    if name in defined:
        return {name}
    if name in _BUILTINS and hasattr(builtins, name):
        return set()
    raise NotAnInterceptorError(f"`{node.name}` uses `{name}`")


def _line(node: ast.AST) -> str:
    return (ast.unparse(node).splitlines() or [type(node).__name__])[0]
