"""Check that a text has the layout of generated monitors, so that nothing in it is hidden.

A proof stops a monitor, restores it and steps it: that is sound only if a step depends only on its
cells and propositions. So every statement must be one that the generator writes. Names of cells,
constants and the logic of a tick are free; marks and signals, which only store and report, have a
fixed form, and parameters and literals have the names that the generator derives from their
propositions.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache

from compiler.program.program import MARKS, SIGNALS
from compiler.targets.python.monitor import is_inlined
from compiler.targets.python.names import MOST_PARAMETERS, parameters_of, prefixes_of
from compiler.targets.python.program import locals_of, negation
from fretc.verification.monitor.column_layout import check_columns
from fretc.verification.monitor.front_layout import check_front, declared_variables
from fretc.verification.monitor.statements import (
    UnexpectedStatementError,
    below_docstring,
    body_of,
    constants,
    is_one_of,
    names_in,
    reads,
    require,
)
from fretc.verification.monitor.tick_layout import (
    FIXED,
    ApproximationNames,
    RowBehaviour,
    check_advance,
)
from fretish.reading.text_encoding import is_utf8
from monitors.kernel.variables import Variable
from monitors.source_text import Runtime, kernel, kernel_of_variables

_OF_APPROXIMATIONS = frozenset({"CELLS", "advance", "signals", "marks"})
"""Other attributes of an approximation."""


def strange(text: str) -> str | None:
    """Why the layout is not that of a generated monitor; None: it is."""
    if not is_utf8(text):
        return "it declares another encoding than UTF-8, so Python would read another text"
    runtime = _runtime(text)
    head, found, own = text.partition(runtime.text)
    try:
        is_alone = head.endswith("\n") and own.startswith("\n")
        if not found or not is_alone or not reads(ast.parse(head).body, runtime.imports):
            return "its runtime part is not the one of this version of fretc"
        _check_module(_parsed(own), by_variables=runtime is kernel_of_variables())
    except SyntaxError as error:
        return f"it is not valid Python: {error}"
    except UnexpectedStatementError as error:
        return str(error)
    return None


def own(text: str) -> ast.Module:
    """The part of a monitor's text below the runtime; `strange` has checked its layout.

    The tree is cached and must not be changed.
    """
    return _parsed(text.partition(_runtime(text).text)[2])


@lru_cache(maxsize=4)
def _parsed(own: str) -> ast.Module:
    return ast.parse(own)


def _runtime(text: str) -> Runtime:
    """The runtime of a monitor of variables, if it is in the text; else the other one."""
    longer = kernel_of_variables()
    return longer if longer.text in text else kernel()


def _check_module(module: ast.Module, *, by_variables: bool) -> None:
    match module.body:
        case [ast.ClassDef() as approximation, ast.ClassDef() as monitor, binding, run]:
            pass
        case _:
            raise UnexpectedStatementError(
                "it is not laid out as fretc writes it: two classes and no more"
            )
    title = approximation.name.removesuffix("Approximation")
    require(approximation.name == f"{title}Approximation" and title != "", approximation)
    require(
        monitor.name == f"{title}Monitor" and _is_plain(approximation) and _is_plain(monitor),
        monitor,
    )
    base = "VariableMonitor" if by_variables else "Monitor"
    require(
        [ast.unparse(each) for each in (*approximation.bases, *monitor.bases)] == [base], monitor
    )
    require(is_one_of(binding, f"MONITOR: 'type[{base}]' = {monitor.name}"), binding)
    _check_annotations(module, title)
    main = "main_by_variables" if by_variables else "main"
    require(is_one_of(run, f'if __name__ == "__main__":\n    sys.exit({main}(MONITOR))'), run)
    names, advance = _approximation(approximation)
    inputs, step, verdicts = _monitor(monitor, approximation.name, names, by_variables=by_variables)
    reserved = {*FIXED, *_OF_APPROXIMATIONS, *locals_of(inputs.values())}
    require(reserved.isdisjoint(names.cells), approximation)
    suffixes = tuple(f"_{name}" for name in (*MARKS, "signals"))
    require(
        not any(cell.startswith("_") or cell.endswith(suffixes) for cell in names.cells),
        approximation,
    )
    tick = check_advance(advance, names, inputs)
    _check_verdicts(verdicts, names.prefixes, tick)
    if not by_variables:
        _check_step(step, tuple(inputs.values()), names.prefixes, tick)


def _check_annotations(module: ast.Module, title: str) -> None:
    """Check annotations: names, and texts, which Python 3.8 can only read so."""
    allowed = {*_NAMES, *map(repr, _ANNOTATIONS), f"{title}Approximation"}
    for node in ast.walk(module):
        match node:
            case ast.FunctionDef(returns=ast.expr() as annotation):
                require(ast.unparse(annotation) in allowed, annotation)
            case ast.AnnAssign(_, annotation) | ast.arg(_, ast.expr() as annotation):
                require(ast.unparse(annotation) in allowed, annotation)


_NAMES = (
    *("None", "bool", "int", "Truth", "Verdict", "Number"),
    *(f"ClassVar[{kept!r}]" for kept in ("tuple[str, ...]", "Mapping[str, str]")),
    "ClassVar['Mapping[str, Variable]']",
    "tuple[bool, ...]",  # Of an attribute in a function: Python does not evaluate it.
)
_ANNOTATIONS = frozenset(
    (
        *("tuple[Verdict, ...]", "type[Monitor]", "type[VariableMonitor]"),
        *(
            "tuple[Signals[bool], ...]",
            "tuple[Signals[int], ...]",
            "tuple[Marks, ...]",
        ),
        *("Iterable[Sequence[Any]]", "Iterable[Row | Mapping[str, Truth]]"),
        *("str | None", "tuple[Truth, ...]"),
        "Iterable[Sequence[Value] | Mapping[str, Value]]",
    )
)


def _is_plain(node: ast.ClassDef) -> bool:
    plain = not node.keywords and not node.decorator_list
    return plain and not getattr(node, "type_params", ())


def _approximation(node: ast.ClassDef) -> tuple[ApproximationNames, ast.stmt]:
    """Names of the approximation; checks everything except `advance`."""
    body = below_docstring(node)
    require(len(body) == 6, node)
    slots, cells, initial, advance, signals, marks = body
    match slots, cells:
        case (
            ast.Assign([ast.Name("__slots__")], all_slots),
            ast.AnnAssign(ast.Name("CELLS"), _, ast.expr() as all_cells),
        ):
            pass
        case _:
            raise UnexpectedStatementError(
                "it is not laid out as fretc writes it: `__slots__`, `CELLS`"
            )
    prefixes = _prefixes(signals, marks)
    names = ApproximationNames(names_in(all_cells), frozenset(_windows(initial)), prefixes)
    reserved = ("is_possible", "tick", *names.marks, *names.signals)
    everything = (*reserved, *names.cells)
    require(len({*everything}) == len(everything), cells)
    require(sorted(names_in(all_slots)) == sorted(everything), slots)
    _check_initial(initial, names)
    return names, advance


def _prefixes(signals: ast.stmt, marks: ast.stmt) -> tuple[str, ...]:
    """Prefixes of the requirements, from the signals of an approximation."""
    prefixes = tuple(
        node.attr.removesuffix("_signals")
        for node in ast.walk(signals)
        if isinstance(node, ast.Attribute) and node.attr.endswith("_signals")
    )
    noted = (", ".join(f"self.{prefix}_{mark}" for mark in MARKS) for prefix in prefixes)
    for function, name, values in (
        (signals, "signals", ", ".join(f"Signals(*self.{prefix}_signals)" for prefix in prefixes)),
        (marks, "marks", ", ".join(f"Marks({each})" for each in noted)),
    ):
        body = body_of(function, name, "self")
        require(len(body) == 1 and is_one_of(body[0], f"return ({values},)"), function)
    return prefixes


def _windows(initial: ast.stmt) -> Iterator[str]:
    for node in ast.walk(initial):
        match node:
            case ast.Assign([ast.Attribute(attr=name)], ast.Call(ast.Name("Window"))):
                yield name


def _check_initial(node: ast.stmt, approximation: ApproximationNames) -> None:
    fixed = {"is_possible": "is_possible", **dict.fromkeys(("tick", *approximation.marks), "-1")}
    signals = dict.fromkeys(approximation.signals, f"(False,) * {len(SIGNALS)}")
    names = []
    for statement in body_of(node, "__init__", "self, is_possible: bool = False"):
        match statement:
            case ast.Assign([ast.Attribute(ast.Name("self"), name)], value):
                right = name in approximation.cells and _is_initial(value)
                require(right or is_one_of(value, fixed.get(name, "nothing")), statement)
                names.append(name)
            case ast.AnnAssign(ast.Attribute(ast.Name("self"), name), _, ast.expr() as value):
                require(is_one_of(value, signals.get(name, "nothing")), statement)
                names.append(name)
            case _:
                require(False, statement)
    require(sorted(names) == sorted((*fixed, *signals, *approximation.cells)), node)


def _is_initial(node: ast.expr) -> bool:
    match node:
        case ast.Call(ast.Name("Window"), [ast.Constant(int(lo)), ast.Constant(int(hi))], []):
            return 0 <= lo <= hi  # Otherwise the saved state would be incomplete.
        case ast.UnaryOp(ast.USub(), ast.Constant(value)) | ast.Constant(value):
            return isinstance(value, int)
        case _:
            return False


def _monitor(
    node: ast.ClassDef, approximation: str, names: ApproximationNames, *, by_variables: bool
) -> tuple[Mapping[str, str], ast.stmt, ast.stmt]:
    """Propositions of a monitor with their parameters, its `step` and its `verdicts`.

    Checks everything except `verdicts` and, if it is not stepped by variables, `step`.
    """
    body = below_docstring(node)
    variables = [body.pop(3), body.pop(7)] if by_variables and len(body) == 13 else []
    require(len(body) == 11 and by_variables is bool(variables), node)
    program, requirements, propositions, literals, *rest = body
    approximation_binding, certain, possible, step, run, verdicts, columns = rest
    require(isinstance(program, ast.Assign) and _is_text(program, "PROGRAM"), program)
    _check_requirements(requirements, names.prefixes)
    declared = declared_variables(variables[0]) if variables else {}
    inputs = _inputs(propositions, names.prefixes, declared)
    literal_names = _literals(literals, inputs)
    require(
        is_one_of(approximation_binding, f"APPROXIMATION = {approximation}"), approximation_binding
    )
    require(
        is_one_of(certain, f"certain: {approximation}")
        and is_one_of(possible, f"possible: {approximation}"),
        certain,
    )
    if variables:
        check_front(
            (variables[1], step, run), declared, tuple(inputs.values()), len(names.prefixes)
        )
    else:
        rows = "self, rows: 'Iterable[Row | Mapping[str, Truth]]'"
        ran = f"self.advance(rows)\nreturn {_all_verdicts(names.prefixes)}"
        require(reads(body_of(run, "run", rows), ran), run)
    check_columns(columns, literal_names)
    return inputs, step, verdicts


def _all_verdicts(prefixes: Sequence[str]) -> str:
    return "self.verdicts()" + "[0]" * (len(prefixes) == 1)


def _check_requirements(node: ast.stmt, prefixes: Sequence[str]) -> None:
    ids: list[str] = []
    match node:
        case ast.Assign([ast.Name("REQUIREMENTS")], ast.Tuple(entries)):
            for entry in entries:
                match entry:
                    case ast.Call(ast.Name("Requirement"), [ast.Constant(str(id)), *rest], []):
                        require(len(rest) == 3, entry)
                        require(all(isinstance(value, ast.Constant) for value in rest), entry)
                        ids.append(id)
                    case _:
                        require(False, entry)
        case _:
            require(False, node)
    require(bool(ids) and "" not in ids and len({*ids}) == len(ids), node)
    require(tuple(prefixes_of(ids).values()) == tuple(prefixes), node)


def _inputs(
    node: ast.stmt, prefixes: Sequence[str], variables: Mapping[str, Variable]
) -> Mapping[str, str]:
    """Parameter of each proposition, as the generator derives it from the name."""
    match node:
        case ast.AnnAssign(ast.Name("PROPOSITIONS"), _, ast.Dict(keys, values)):
            names = names_in(ast.Tuple([key for key in keys if key is not None]))
            require(len({*names}) == len(keys) and all(names), node)
            parameters = parameters_of(names, prefixes, variables)
            inputs = {name: parameters[name] for name in names}
            require(tuple(inputs.values()) == names_in(ast.Tuple(values)), node)
            require(all(v.parameter == parameters[n] for n, v in variables.items()), node)
            return inputs
        case _:
            require(False, node)
            return {}


def _literals(node: ast.stmt, inputs: Mapping[str, str]) -> tuple[str, ...]:
    """Names of literals: a proposition's parameter, or that of its negation."""
    match node:
        case ast.Assign([ast.Name("LITERALS")], ast.Tuple(entries)):
            names: list[str] = []
            for entry in entries:
                name, proposition, positive = (*constants(entry), None, None, None)[:3]
                parameter = inputs.get(str(proposition), "")
                right = parameter if positive is True else negation(parameter)
                require(parameter != "" and isinstance(positive, bool) and name == right, entry)
                names.append(right)
            return tuple(names)
        case _:
            require(False, node)
            return ()


def _check_step(
    node: ast.stmt, inputs: Sequence[str], prefixes: Sequence[str], tick: RowBehaviour
) -> None:
    """Check the signature of `step`; if the tick is inlined, check that it equals `advance`."""
    parameters = "self, *, " + ", ".join(f"{name}: Truth" for name in inputs)
    row = f"({', '.join(inputs)}{',' * (len(inputs) == 1)})"
    if len(inputs) > MOST_PARAMETERS:
        parameters, row = "self, **propositions: Truth", "self._row(propositions)"
    text = f"self._step({row})\nreturn {_all_verdicts(prefixes)}"
    if is_inlined(len(prefixes), len(inputs)):
        odd = "".join(f" or ({name} is not True and {name} is not False)" for name in inputs)
        slow = text.replace("\n", "\n    ")
        text = "approximation = self.certain\n"
        text += f"if approximation is not self.possible{odd}:\n    {slow}\n"
        text += f"{tick.inlined}\n{_verdict(prefixes[0], tick)}"
    body = body_of(node, "step", parameters if inputs else "self")
    for statement, expected in zip(body, ast.parse(text).body, strict=False):
        require(is_one_of(statement, ast.unparse(expected)), statement)
    require(reads(body, text), node)


def _verdict(prefix: str, tick: RowBehaviour) -> str:
    """The end of a step with an inlined tick."""
    text = f"if {_violated('approximation', prefix, tick)}:\n    return VIOLATED\n"
    if prefix in tick.satisfied_forever:
        text += f"if approximation.{prefix}_signals[{_SATISFIED_FOREVER}]:\n    return SATISFIED\n"
    return f"{text}return PENDING"


def _check_verdicts(node: ast.stmt, prefixes: Sequence[str], tick: RowBehaviour) -> None:
    """Check that verdicts follow from marks and signals of both approximations."""
    values = []
    for prefix in prefixes:
        rest = "PENDING"
        if prefix in tick.satisfied_forever:
            forever = f"certain.{prefix}_signals[{_SATISFIED_FOREVER}]"
            violated = _violated("possible", prefix, tick)
            rest = f"SATISFIED if {forever} and not ({violated}) else PENDING"
        values.append(f"VIOLATED if {_violated('certain', prefix, tick)} else {rest}")
    approximations = "certain = self.certain\n" + "possible = self.possible\n" * bool(
        tick.satisfied_forever
    )
    text = f"{approximations}return ({', '.join(values)},)"
    require(reads(body_of(node, "verdicts", "self"), text), node)


_SATISFIED_FOREVER = SIGNALS.index("satisfied_forever")


def _violated(approximation: str, prefix: str, tick: RowBehaviour) -> str:
    inevitable = (
        f" or {approximation}.{prefix}_violation_inevitable >= 0"
        if prefix in tick.violation_inevitable
        else ""
    )
    return f"{approximation}.{prefix}_broken >= 0{inevitable}"


def _is_text(node: ast.Assign, name: str) -> bool:
    match node:
        case ast.Assign([ast.Name(id)], ast.Constant(str())):
            return id == name
        case _:
            return False
