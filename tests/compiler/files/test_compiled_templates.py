"""Compiled templates are kept as Python keeps modules, and never stand for another text."""

import sys
from collections.abc import Iterator
from pathlib import Path

import jinja2
import pytest

from compiler.files import templating

TEXT = "{% for name in names %}{{ name }} {% endfor %}"


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of templates with one template."""
    monkeypatch.setattr(templating, "template_root", lambda: tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    (tmp_path / "a.j2").write_text(TEXT)
    templating._environment.cache_clear()
    yield tmp_path
    templating._environment.cache_clear()


def rendered() -> str:
    """As in a new process."""
    templating._environment.cache_clear()
    return templating.render("a.j2", names=["x", "y"])


def compiles(monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether it is compiled once more; what comes out is the same in any case."""
    calls = []
    compile_ = jinja2.Environment.compile

    def counted(*args: object, **options: object) -> object:
        calls.append(args)
        return compile_(*args, **options)  # type: ignore[call-overload]

    with monkeypatch.context() as patch:
        patch.setattr(jinja2.Environment, "compile", counted)
        assert rendered() == "x y "
    return bool(calls)


def kept(root: Path) -> Path:
    (file,) = (root / "__pycache__").iterdir()
    return file


def test_a_template_is_compiled_once(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert compiles(monkeypatch)
    assert not compiles(monkeypatch)


def test_a_changed_template_is_compiled_anew(root: Path) -> None:
    rendered()
    (root / "a.j2").write_text(f"{TEXT}!")
    assert rendered() == "x y !"
    assert len([*(root / "__pycache__").iterdir()]) == 1


def test_another_jinja_compiles_anew(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rendered()
    monkeypatch.setattr(jinja2, "__version__", "0")
    assert compiles(monkeypatch)


@pytest.mark.slow
def test_a_file_that_ends_early_is_none(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rendered()
    whole = kept(root).read_bytes()
    for length in range(0, len(whole), 7):
        kept(root).write_bytes(whole[:length])
        assert compiles(monkeypatch)
        assert kept(root).read_bytes() == whole


def test_nothing_is_kept_where_python_keeps_nothing(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert rendered() == "x y "
    assert [*root.iterdir()] == [root / "a.j2"]


def test_a_folder_that_cannot_be_written_costs_nothing(root: Path) -> None:
    (root / "__pycache__").write_text("a file")
    assert rendered() == rendered() == "x y "
