"""Whether a text is laid out as generated monitors are, so that nothing in it is hidden.

A proof stops a monitor, puts it back and steps it: that is sound only where a step depends on its
cells and propositions and on nothing else. So every statement of the text must be one that the
generator writes. The names of cells, constants and the logic of a tick may be any; of marks and
signals, which only remember and tell, the form is fixed, and parameters and literals have the names
that the generator gives to their propositions.
"""

from __future__ import annotations

import ast
import tokenize
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from io import BytesIO

from compiler.program import MARKS, SIGNALS, locals_of, negation
from compiler.runtime import kernel
from compiler.targets.monitor import parameters_of, prefixes_of

_COLUMNS = frozenset(
    "previous weak_previous once historically since released since_from since_between "
    "released_between".split()
)
"""What a column program calls."""
_FIXED = frozenset({"self", "rows", "known", "doubt", "tick", "boolean"})
"""What a tick calls its own, and what it calls."""
_OF_RAILS = frozenset({"CELLS", "advance", "signals", "marks"})
"""What else a rail has."""


class _StrangeError(Exception):
    """What is not as the generator writes it."""


def strange(text: str) -> str | None:
    """Why the text may do more than it seems to; None: it does not."""
    if not is_utf8(text):
        return "it declares another encoding than UTF-8, so Python would read another text"
    head, found, own = text.partition(kernel().text)
    try:
        if not found or not head.endswith("\n") or not own.startswith("\n") or not _is_head(head):
            return "the run time in it is not the one of this version of fretc"
        _check_module(ast.parse(own))
    except SyntaxError as error:
        return f"it is no Python: {error}"
    except _StrangeError as error:
        return str(error)
    return None


def own(text: str) -> ast.Module:
    """What of a monitor's text stands below the run time; it is laid out as fretc writes it."""
    return ast.parse(text.partition(kernel().text)[2])


def is_utf8(text: str) -> bool:
    """Whether Python reads a file with this text in UTF-8, as fretc does.

    Another encoding can make code of what is a comment here. Source: PEP 263.
    """
    lines = text.replace("\r\n", "\n").replace("\r", "\n").encode()
    try:
        encoding, _ = tokenize.detect_encoding(BytesIO(lines).readline)
    except SyntaxError:
        return False
    return encoding in ("utf-8", "utf-8-sig")


def _is_head(head: str) -> bool:
    return ast.unparse(ast.parse(head)) == _normal(kernel().imports)


# Helpers --------------------------------------------------------------------------------------


@cache
def _normal(text: str) -> str:
    return ast.unparse(ast.parse(text))


def _is(node: ast.AST, *texts: str) -> bool:
    """The node is one of these statements or expressions."""
    found = ast.unparse(node)
    return any(found == _normal(text) for text in texts)


def _demand(right: bool, node: ast.AST) -> None:
    if not right:
        line = (ast.unparse(node).splitlines() or ["nothing"])[0]
        raise _StrangeError(f"it is not laid out as fretc writes it: `{line}`")


def _constants(node: ast.AST | None) -> tuple[object, ...]:
    """The values of a tuple of constants."""
    assert node is not None
    _demand(isinstance(node, ast.Tuple), node)
    assert isinstance(node, ast.Tuple)
    for part in node.elts:
        _demand(isinstance(part, ast.Constant), part)
    return tuple(part.value for part in node.elts if isinstance(part, ast.Constant))


def _names(node: ast.AST | None) -> tuple[str, ...]:
    found = _constants(node)
    names = tuple(value for value in found if isinstance(value, str))
    if node is not None:
        _demand(names == found, node)
    return names


def _function(node: ast.stmt, name: str, arguments: str, *decorators: str) -> list[ast.stmt]:
    """The statements of a function below its docstring."""
    _demand(isinstance(node, ast.FunctionDef), node)
    assert isinstance(node, ast.FunctionDef)
    _demand(node.name == name and not getattr(node, "type_params", ()), node)
    _demand(ast.unparse(node.args) == ast.unparse(_arguments(arguments)), node.args)
    _demand([ast.unparse(d) for d in node.decorator_list] == [*decorators], node)
    return _below_docstring(node)


def _arguments(text: str) -> ast.arguments:
    function = ast.parse(f"def f({text}): pass").body[0]
    assert isinstance(function, ast.FunctionDef)
    return function.args


def _below_docstring(node: ast.FunctionDef | ast.ClassDef) -> list[ast.stmt]:
    return node.body[1:] if ast.get_docstring(node) is not None else node.body


# Module and classes ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Rail:
    """The names of a rail."""

    cells: tuple[str, ...]
    windows: frozenset[str]
    prefixes: tuple[str, ...]

    @property
    def marks(self) -> tuple[str, ...]:
        return tuple(f"{prefix}_{mark}" for prefix in self.prefixes for mark in MARKS)

    @property
    def signals(self) -> tuple[str, ...]:
        return tuple(f"{prefix}_{signal}" for prefix in self.prefixes for signal in SIGNALS)


def _check_module(module: ast.Module) -> None:
    match module.body:
        case [ast.ClassDef() as rail, ast.ClassDef() as monitor, named, run]:
            pass
        case _:
            raise _StrangeError("it is not laid out as fretc writes it: two classes and no more")
    title = rail.name.removesuffix("Rail")
    _demand(rail.name == f"{title}Rail" and title != "", rail)
    _demand(monitor.name == f"{title}Monitor" and _is_plain(rail) and _is_plain(monitor), monitor)
    _demand([ast.unparse(base) for base in (*rail.bases, *monitor.bases)] == ["Monitor"], monitor)
    _demand(_is(named, f"MONITOR: type[Monitor] = {monitor.name}"), named)
    _check_annotations(module, title)
    _demand(_is(run, 'if __name__ == "__main__":\n    sys.exit(main(MONITOR))'), run)
    names, advance = _rail(rail)
    inputs = _monitor(monitor, rail.name, names)
    reserved = {*_FIXED, *_OF_RAILS, *locals_of(inputs.values())}
    _demand(reserved.isdisjoint(names.cells), rail)
    _demand(not any(cell.startswith("_") for cell in names.cells), rail)
    _check_advance(advance, names, inputs)


def _check_annotations(module: ast.Module, title: str) -> None:
    """They are evaluated when the text is executed: those that the generator writes do nothing."""
    allowed = {*_ANNOTATIONS, f"{title}Rail"}
    for node in ast.walk(module):
        match node:
            case ast.FunctionDef(returns=ast.expr() as annotation):
                _demand(ast.unparse(annotation) in allowed, annotation)
            case ast.AnnAssign(_, annotation) | ast.arg(_, ast.expr() as annotation):
                _demand(ast.unparse(annotation) in allowed, annotation)


_ANNOTATIONS = frozenset(
    (
        *("None", "bool", "int", "Truth", "Verdict", "tuple[Verdict, ...]", "type[Monitor]"),
        *("tuple[Signals[bool], ...]", "tuple[Signals[int], ...]", "tuple[Marks, ...]"),
        *("ClassVar[tuple[str, ...]]", "ClassVar[Mapping[str, str]]"),
        *("Iterable[Sequence[Any]]", "Iterable[Row | Mapping[str, Truth]]"),
    )
)


def _is_plain(node: ast.ClassDef) -> bool:
    plain = not node.keywords and not node.decorator_list
    return plain and not getattr(node, "type_params", ())


def _rail(node: ast.ClassDef) -> tuple[_Rail, ast.stmt]:
    """The names of a rail, once all of it but `advance` is known to be as it should."""
    body = _below_docstring(node)
    _demand(len(body) == 6, node)
    slots, cells, initial, advance, signals, marks = body
    match slots, cells:
        case ast.Assign([ast.Name("__slots__")], all_slots), ast.AnnAssign(ast.Name("CELLS")):
            pass
        case _:
            raise _StrangeError("it is not laid out as fretc writes it: `__slots__`, `CELLS`")
    prefixes = _told(signals, marks)
    named = _Rail(_names(cells.value), frozenset(_windows(initial)), prefixes)
    reserved = ("doubt", "tick", *named.marks, *named.signals)
    everything = (*reserved, *named.cells)
    _demand(len({*everything}) == len(everything), cells)
    _demand(sorted(_names(all_slots)) == sorted(everything), slots)
    _check_initial(initial, named)
    return named, advance


def _told(signals: ast.stmt, marks: ast.stmt) -> tuple[str, ...]:
    """The prefixes of the requirements, from what a rail tells of them."""
    (returned,) = _function(signals, "signals", "self") or [signals]
    prefixes = tuple(
        node.attr.removesuffix("_trigger")
        for node in ast.walk(returned)
        if isinstance(node, ast.Attribute) and node.attr.endswith("_trigger")
    )
    for function, name, kind, names in (
        (signals, "signals", "Signals", SIGNALS),
        (marks, "marks", "Marks", MARKS),
    ):
        told = ", ".join(
            f"{kind}({', '.join(f'self.{prefix}_{name}' for name in names)})" for prefix in prefixes
        )
        body = _function(function, name, "self")
        _demand(len(body) == 1 and _is(body[0], f"return ({told},)"), function)
    return prefixes


def _windows(initial: ast.stmt) -> Iterator[str]:
    for node in ast.walk(initial):
        match node:
            case ast.Assign([ast.Attribute(attr=name)], ast.Call(ast.Name("Window"))):
                yield name


def _check_initial(node: ast.stmt, rail: _Rail) -> None:
    fixed = {"doubt": "doubt", **dict.fromkeys(("tick", *rail.marks), "-1")}
    fixed |= dict.fromkeys(rail.signals, "False")
    found = []
    for statement in _function(node, "__init__", "self, doubt: bool = False"):
        match statement:
            case ast.Assign([ast.Attribute(ast.Name("self"), name)], value):
                right = name in rail.cells and _is_initial(value)
                _demand(right or _is(value, fixed.get(name, "nothing")), statement)
                found.append(name)
            case _:
                _demand(False, statement)
    _demand(sorted(found) == sorted((*fixed, *rail.cells)), node)


def _is_initial(node: ast.expr) -> bool:
    match node:
        case ast.Call(ast.Name("Window"), [ast.Constant(int()), ast.Constant(int())], []):
            return True
        case ast.UnaryOp(ast.USub(), ast.Constant(value)) | ast.Constant(value):
            return isinstance(value, int)
        case _:
            return False


def _monitor(node: ast.ClassDef, rail: str, names: _Rail) -> Mapping[str, str]:
    """Its propositions with their parameters, once it is known to be as it should."""
    body = _below_docstring(node)
    _demand(len(body) == 10, node)
    program, requirements, propositions, literals, named, must, may, step, run, columns = body
    _demand(isinstance(program, ast.Assign) and _is_text(program, "PROGRAM"), program)
    _check_requirements(requirements, names.prefixes)
    inputs = _inputs(propositions, names.prefixes)
    given = _literals(literals, inputs)
    _demand(_is(named, f"RAIL = {rail}"), named)
    _demand(_is(must, f"must: {rail}") and _is(may, f"may: {rail}"), must)
    alone = names.prefixes[0] if len(names.prefixes) == 1 else None
    verdicts = "" if alone is None else "[0]"
    rows = "self, rows: Iterable[Row | Mapping[str, Truth]]"
    told = "\n".join(map(ast.unparse, _function(run, "run", rows)))
    _demand(told == f"self.advance(rows)\nreturn self.verdicts(){verdicts}", run)
    parameters = ", ".join(f"{name}: Truth" for name in inputs.values())
    stepped = _function(step, "step", f"self, *, {parameters}" if inputs else "self")
    _check_step(stepped, tuple(inputs.values()), names.prefixes)
    _check_columns(columns, given)
    return inputs


def _check_requirements(node: ast.stmt, prefixes: Sequence[str]) -> None:
    ids: list[str] = []
    match node:
        case ast.Assign([ast.Name("REQUIREMENTS")], ast.Tuple(told)):
            for one in told:
                match one:
                    case ast.Call(ast.Name("Requirement"), [ast.Constant(str(id)), *rest], []):
                        _demand(len(rest) == 3, one)
                        _demand(all(isinstance(value, ast.Constant) for value in rest), one)
                        ids.append(id)
                    case _:
                        _demand(False, one)
        case _:
            _demand(False, node)
    _demand(bool(ids) and "" not in ids and len({*ids}) == len(ids), node)
    _demand(tuple(prefixes_of(ids).values()) == tuple(prefixes), node)


def _inputs(node: ast.stmt, prefixes: Sequence[str]) -> Mapping[str, str]:
    """The parameter of each proposition: the one that the generator makes of its name."""
    match node:
        case ast.AnnAssign(ast.Name("PROPOSITIONS"), _, ast.Dict(keys, values)):
            names = _names(ast.Tuple([key for key in keys if key is not None]))
            _demand(len({*names}) == len(keys) and all(names), node)
            inputs = parameters_of(names, prefixes)
            _demand(tuple(inputs.values()) == _names(ast.Tuple(values)), node)
            return inputs
        case _:
            _demand(False, node)
            return {}


def _literals(node: ast.stmt, inputs: Mapping[str, str]) -> tuple[str, ...]:
    """The names of literals: a proposition's parameter, or that of its negation."""
    match node:
        case ast.Assign([ast.Name("LITERALS")], ast.Tuple(told)):
            names: list[str] = []
            for one in told:
                name, proposition, positive = (*_constants(one), None, None, None)[:3]
                parameter = inputs.get(str(proposition), "")
                right = parameter if positive is True else negation(parameter)
                _demand(parameter != "" and isinstance(positive, bool) and name == right, one)
                names.append(right)
            return tuple(names)
        case _:
            _demand(False, node)
            return ()


def _check_step(body: Sequence[ast.stmt], inputs: Sequence[str], prefixes: Sequence[str]) -> None:
    """Both rails take the row, and what they remember is told."""
    fork = " or ".join(f"{name} is None" for name in inputs)
    text = f"row = ({', '.join(inputs)}{',' * (len(inputs) == 1)})\n"
    text += f"if {fork}:\n    self._fork()\n" if inputs else ""
    text += "must, may = self.must, self.may\nmust.advance((row,))\n"
    text += "if may is not must:\n    may.advance((row,))"
    head = len(ast.parse(text).body)
    _demand("\n".join(map(ast.unparse, body[:head])) == _normal(text), body[0])
    if len(prefixes) == 1:
        told = "\n".join(map(ast.unparse, body[head:]))
        _demand(told in {_normal(_alone(*form)) for form in _forms(prefixes[0])}, body[head])
        return
    match body[head:]:
        case [ast.Return(ast.Tuple(verdicts))] if len(verdicts) == len(prefixes):
            for prefix, verdict in zip(prefixes, verdicts, strict=True):
                forms = {_normal(_beside_others(*form)) for form in _forms(prefix)}
                _demand(ast.unparse(verdict) in forms, verdict)
        case _:
            _demand(False, body[head])


def _forms(prefix: str) -> Iterator[tuple[str, str | None]]:
    """When a requirement is violated, and when it is satisfied: what can never be is left out."""
    for doom in (False, True):
        violated, possible = (
            f"{rail}.{prefix}_broken >= 0" + f" or {rail}.{prefix}_doomed >= 0" * doom
            for rail in ("must", "may")
        )
        yield violated, None
        yield violated, f"must.{prefix}_settled and not ({possible})"


def _alone(violated: str, satisfied: str | None) -> str:
    text = f"if {violated}:\n    return VIOLATED\n"
    text += f"if {satisfied}:\n    return SATISFIED\n" if satisfied else ""
    return f"{text}return PENDING"


def _beside_others(violated: str, satisfied: str | None) -> str:
    rest = f"SATISFIED if {satisfied} else PENDING" if satisfied else "PENDING"
    return f"VIOLATED if {violated} else {rest}"


def _is_text(node: ast.Assign, name: str) -> bool:
    match node:
        case ast.Assign([ast.Name(id)], ast.Constant(str())):
            return id == name
        case _:
            return False


# A tick ---------------------------------------------------------------------------------------


def _check_advance(node: ast.stmt, rail: _Rail, inputs: Mapping[str, str]) -> None:
    body = _function(node, "advance", "self, rows: Iterable[Sequence[Any]]")
    place = next((i for i, part in enumerate(body) if isinstance(part, ast.For)), None)
    _demand(place is not None, node)
    assert place is not None
    loop = body[place]
    assert isinstance(loop, ast.For)
    carried = tuple(_carried(body[:place], rail))
    _demand(_is(loop.iter, "rows") and not loop.orelse, loop)
    row = ", ".join(inputs.values()) + "," * (len(inputs) == 1)
    _demand(_is(loop.target, f"({row})" if inputs else "_"), loop)
    _demand(bool(loop.body) and _is(loop.body[0], "tick += 1"), loop)
    bound = _Tick(rail, frozenset(carried)).check(loop.body[1:], inputs)
    _check_end(body[place + 1 :], rail, carried, bound)


def _carried(statements: Sequence[ast.stmt], rail: _Rail) -> Iterator[str]:
    """The names that are read from the rail before the first row."""
    fixed = [ast.unparse(statement) for statement in statements]
    _demand(
        fixed[:3] == ["known = True", "doubt = self.doubt", "tick = self.tick"], *statements[:1]
    )
    allowed = (*rail.cells, *rail.marks)
    for statement in statements[3:]:
        name = ast.unparse(statement).partition(" = ")[0]
        _demand(name in allowed and _is(statement, f"{name} = self.{name}"), statement)
        yield name
    _demand(all(f"{cell} = self.{cell}" in fixed for cell in rail.cells), *statements[:1])


def _check_end(
    statements: Sequence[ast.stmt], rail: _Rail, carried: Iterable[str], bound: frozenset[str]
) -> None:
    """What is done after the last row: cells and marks go back, signals are told."""
    kept = {f"self.{name} = {name}" for name in ("tick", *carried)}
    opened = {f"{p}_open = {p}_last if self.{p}_owed else -1": p for p in rail.prefixes}
    told: set[str] = set()
    (first, *rest, last) = statements if len(statements) > 1 else (*statements, *statements)
    _demand(_is(first, "if tick == self.tick:\n    return True"), first)
    _demand(_is(last, "return known"), last)
    for statement in rest:
        text = ast.unparse(statement)
        if text in kept:
            kept.remove(text)
            continue
        if text in opened:  # of the last tick, and not yet put back
            _demand(f"{opened[text]}_owed" in told, statement)
            _demand(f"self.{opened[text]}_open = {opened[text]}_open" in kept, statement)
            continue
        match statement:
            case ast.Assign([ast.Attribute(ast.Name("self"), name)], value):
                _demand(name in rail.signals and name not in told, statement)
                _check_value(value, bound - rail.windows, frozenset())
                told.add(name)
            case _:
                _demand(False, statement)
    _demand(not kept, first)


@dataclass(frozen=True, slots=True)
class _Tick:
    """The statements that are executed for each row."""

    rail: _Rail
    carried: frozenset[str]

    def check(self, statements: Sequence[ast.stmt], inputs: Mapping[str, str]) -> frozenset[str]:
        """The names that have a value after them."""
        bound = {*self.rail.cells}
        rest = [*statements]
        for proposition, name in inputs.items():
            both = name
            if rest and _is(rest[0], f"{negation(name)} = not {name}"):
                rest.pop(0)
                both = f"{name} = {negation(name)}"
                bound.add(negation(name))
            bound.add(name)
            block = f"""\
if {name} is not True and {name} is not False:
    if {name} is None:
        known = False
        {both} = doubt
    else:
        {name} = boolean({name}, {proposition!r})"""
            _demand(bool(rest) and _is(rest[0], block), rest[0] if rest else ast.Module([], []))
            rest.pop(0)
        return self._after(rest, frozenset(bound))

    def _after(self, statements: Iterable[ast.stmt], bound: frozenset[str]) -> frozenset[str]:
        """Those of `bound`, and what the statements give a value on every way through them."""
        for statement in statements:
            if self._remembers(statement, bound):
                continue
            match statement:
                case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
                    _demand(len(targets) == len(values), statement)
                case ast.Assign([ast.Name() as target], value):
                    targets, values = [target], [value]
                case ast.If(test, body, orelse):
                    self._check(test, bound)
                    bound = self._after(body, bound) & self._after(orelse, bound)
                    continue
                case _:
                    _demand(False, statement)
            for value in values:
                self._check(value, bound)
            bound |= {self._target(target) for target in targets}
        return bound

    def _target(self, node: ast.expr) -> str:
        fixed = {*_FIXED, *self.rail.marks, *self.rail.windows}
        _demand(isinstance(node, ast.Name) and node.id not in fixed, node)
        assert isinstance(node, ast.Name)
        return node.id

    def _check(self, value: ast.expr, bound: frozenset[str]) -> None:
        _check_value(value, bound - self.rail.windows, self.rail.windows)

    def _remembers(self, statement: ast.stmt, bound: frozenset[str]) -> bool:
        """It notes the tick of an event in a mark, and does nothing else."""
        for mark in self.carried.intersection(self.rail.marks):
            noted, kind = f"{mark} = tick", mark.rpartition("_")[2]
            match statement:
                case ast.Assign() if kind == "last" and _is(statement, noted):
                    return True
                case ast.If(test, [body], []) if kind == "last" and _is(body, noted):
                    self._check(test, bound)
                    return True
                case ast.If(ast.BoolOp(ast.And(), [once, *tests]), [body], []) if (
                    kind in ("broken", "doomed") and _is(once, f"{mark} < 0") and _is(body, noted)
                ):
                    for test in tests:
                        self._check(test, bound)
                    return True
                case ast.If(ast.UnaryOp(ast.Not(), test), [closed], [opened]) if (
                    kind == "open"
                    and _is(closed, f"{mark} = -1")
                    and _is(opened, f"if {mark} < 0:\n    {noted}")
                ):
                    self._check(test, bound)
                    return True
        return False


_OPERATORS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)
"""Those that cannot tell True from 1: for a proof they are one state."""


def _check_value(node: ast.expr, bound: frozenset[str], windows: frozenset[str]) -> None:
    """It depends on nothing but names that have a value at this tick."""

    def check(*parts: ast.expr) -> None:
        for part in parts:
            _check_value(part, bound, windows)

    match node:
        case ast.Name(name):
            if name not in bound:
                raise _StrangeError(f"what it does at a tick depends on `{name}`")
        case ast.Constant(value):
            _demand(isinstance(value, int), node)
        case ast.UnaryOp(ast.Not() | ast.USub(), arg):
            check(arg)
        case ast.BoolOp(_, args):
            check(*args)
        case ast.Compare(left, [operator], [right]):
            _demand(isinstance(operator, _OPERATORS), node)
            check(left, right)
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            check(left, right)
        case ast.IfExp(test, body, orelse):
            check(test, body, orelse)
        case ast.Call(ast.Attribute(ast.Name(name), "step"), [left, right], []):
            _demand(name in windows, node)
            check(left, right)
        case _:
            _demand(False, node)


# Columns --------------------------------------------------------------------------------------


def _check_columns(node: ast.stmt, literals: Sequence[str]) -> None:
    given = ", ".join(f"{name}: int" for name in literals)
    arguments = f"every: int, *, {given}" if literals else "every: int"
    *body, last = _function(node, "columns", arguments, "staticmethod")
    bound = {"every", *literals}
    for statement in body:
        match statement:
            case ast.Assign([ast.Name(name)], value):
                _demand(name not in bound and name not in {*_COLUMNS, "Signals"}, statement)
                _check_column(value, bound)
                bound.add(name)
            case _:
                _demand(False, statement)
    match last:
        case ast.Return(ast.Tuple(told)):
            for one in told:
                match one:
                    case ast.Call(ast.Name("Signals"), [], keywords):
                        for keyword in keywords:
                            _check_column(keyword.value, bound)
                    case _:
                        _demand(False, one)
        case _:
            _demand(False, last)


def _check_column(node: ast.expr, bound: Iterable[str]) -> None:
    match node:
        case ast.Name(name):
            _demand(name in bound, node)
        case ast.Constant(value):
            _demand(value is None or isinstance(value, int), node)
        case ast.BinOp(left, ast.BitAnd() | ast.BitOr(), right):
            _check_column(left, bound)
            _check_column(right, bound)
        case ast.Call(ast.Name(name), args, []):
            _demand(name in _COLUMNS, node)
            for arg in args:
                _check_column(arg, bound)
        case _:
            _demand(False, node)
