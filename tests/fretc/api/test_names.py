"""What `import fretc` offers, and what it costs."""

import ast
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import fretc

FACE = Path(fretc.__file__)


def typed() -> dict[str, str]:
    """The names that a type checker sees, with their modules."""
    (block,) = (
        node for node in ast.parse(FACE.read_text("utf-8")).body if isinstance(node, ast.If)
    )
    return {
        str(alias.asname): node.module or ""
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_a_type_checker_sees_the_names_that_python_sees() -> None:
    assert sorted(typed()) == sorted(fretc.__all__) == sorted(fretc._HOMES)
    for name, module in typed().items():
        home = __import__(module, fromlist=["_"])
        assert getattr(fretc, name) is getattr(home, name, None) or name == "Proof"


def test_no_name_is_that_of_a_module() -> None:
    """Anyone who imported the module would find it in the place of the name."""
    modules = {module.name for module in pkgutil.iter_modules(fretc.__path__)}
    assert modules.isdisjoint(fretc.__all__)


def test_another_name_is_no_attribute() -> None:
    with pytest.raises(AttributeError, match="no attribute `audit_log`"):
        getattr(fretc, "audit_log")  # noqa: B009


def test_a_name_of_the_previous_version_still_works_and_warns() -> None:
    with pytest.warns(DeprecationWarning, match="`fretc.Formalized` is now"):
        assert getattr(fretc, "Formalized") is fretc.FormalizedRequirement  # noqa: B009


def test_all_names_are_listed() -> None:
    assert set(fretc.__all__) <= set(dir(fretc))


def test_importing_it_imports_nothing_heavy() -> None:
    code = "import sys, fretc; dir(fretc); print(*sorted(sys.modules))"
    loaded = subprocess.run(
        [sys.executable, "-c", code],
        cwd=FACE.parent.parent,
        capture_output=True,
        check=True,
        text=True,
    ).stdout.split()
    assert "fretc" in loaded
    roots = {name.partition(".")[0] for name in loaded}
    assert roots.isdisjoint({"numpy", "lark", "spot", "click", "jinja2", "mcap", "compiler"})
    assert not [name for name in loaded if name.startswith("fretc.")]
