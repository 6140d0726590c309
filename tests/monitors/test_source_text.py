"""The modules of the run time become one text, so they share their names."""

import ast
from collections import Counter

import pytest

from monitors.source_text import kernel_of_variables, perception


@pytest.mark.parametrize(
    ("text", "one"),
    [
        (kernel_of_variables().text, "Listing"),
        (perception().text, "StatusPublisher"),
        (perception(rounds=True).text, "ROUNDED_FUNCTIONS"),
    ],
    ids=["monitor", "perception", "functions"],
)
def test_no_two_modules_of_the_run_time_define_one_name(text: str, one: str) -> None:
    """In the text of a monitor the later one would take the place of the other."""
    defined: list[str] = []
    for node in ast.parse(text).body:
        match node:
            case ast.FunctionDef(name) | ast.ClassDef(name) | ast.AnnAssign(ast.Name(name)):
                defined.append(name)
            case ast.Assign(targets):
                names = [name for target in targets for name in ast.walk(target)]
                defined += [name.id for name in names if isinstance(name, ast.Name)]
    assert [name for name, count in Counter(defined).items() if count > 1] == []
    assert one in defined
