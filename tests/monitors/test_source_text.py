"""Modules that become one text do not get into each other's way."""

import ast
from collections import Counter

from monitors.source_text import kernel_of_variables


def test_a_name_of_the_run_time_is_defined_once() -> None:
    """In one text the later one would count for both."""
    names: list[str] = []
    for node in ast.parse(kernel_of_variables().text).body:
        match node:
            case ast.FunctionDef(name) | ast.ClassDef(name) | ast.AnnAssign(ast.Name(name)):
                names.append(name)
            case ast.Assign(targets):
                names += [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
    assert [name for name, count in Counter(names).items() if count > 1] == []
