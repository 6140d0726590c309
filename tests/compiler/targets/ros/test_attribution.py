"""Manifests of packages say exactly what `[project]` does, and never a placeholder."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest
import tomli_w
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from compiler.files.attribution import EXAMPLE, FIELDS, Attribution, InvalidField, attribution
from tests.command import Fretc, write
from tests.effort import FULL

R1 = Path(__file__).parents[4] / "requirements"
KINDS = ("ros1-package", "ros2-package", "ros2-cpp-package")
WHOLE = {
    "maintainer": 'Ada & Bob <née> "O\'Hara"',
    "email": "ada.o-hara+ros@robots.example.org",
    "license": "Apache-2.0 <or> ]]> later",
    "description": "Stops; {{ 7 * 7 }} %s \\ & ünïcode -->",
}
_PRINTABLE = st.characters(exclude_categories=("C", "Z"), include_characters=" ")
LINES = st.text(_PRINTABLE, min_size=1).map(str.strip).filter(bool)


def project(table: dict[str, str] | None) -> None:
    for name in ("r1.fret", "bindings.toml"):
        write(f"requirements/{name}", (R1 / name).read_text("utf-8"))
    write("requirements/fretc.toml", "" if table is None else tomli_w.dumps({"project": table}))


def emitted(fretc: Fretc, *kinds: str) -> dict[str, str]:
    """Text of each manifest, by its kind."""
    emits = [word for kind in kinds for word in ("--emit", kind)]
    shutil.rmtree("out", ignore_errors=True)
    run = fretc("requirements/r1.fret", *emits, "-o", "out")
    assert run.status == 0, run.err
    assert "fill in" not in run.err
    return {str(path): path.read_text("utf-8") for path in Path("out").rglob("*") if path.is_file()}


@pytest.mark.slow
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15 if FULL else 3
)
@given(st.fixed_dictionaries(dict.fromkeys(FIELDS, LINES) | {"email": st.just("a@b.org")}))
@example(WHOLE)
def test_a_manifest_has_what_the_project_says(fretc: Fretc, table: dict[str, str]) -> None:
    assert isinstance(attribution(table), Attribution)
    project(table)
    for kind in KINDS:
        files = emitted(fretc, kind)
        (manifest,) = (text for path, text in files.items() if path.endswith("package.xml"))
        root = ElementTree.fromstring(manifest)
        found = {name: root.findtext(name) for name in ("maintainer", "license", "description")}
        maintainer = root.find("maintainer")
        assert maintainer is not None
        assert found | {"email": maintainer.get("email")} == table
        for path, text in files.items():
            if path.endswith(".py"):
                ast.parse(text)
            assert "maintainer@example.org" not in text


@pytest.mark.parametrize("missing", [*FIELDS, None])
def test_what_is_missing_is_asked_for_once(fretc: Fretc, missing: str | None) -> None:
    project({k: v for k, v in WHOLE.items() if k != missing} if missing else None)
    run = fretc("requirements/r1.fret", *(word for kind in KINDS for word in ("--emit", kind)))
    assert run.status == 2
    assert run.err.count("F634") == 1
    names = missing or ", ".join(FIELDS)
    assert f"fields that `[project]` of fretc.toml lacks: {names}\n" in run.err
    assert f"\n\n{EXAMPLE}" in run.err
    assert not Path("build").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("maintainer", ""),
        ("maintainer", " "),
        ("maintainer", 3),
        ("maintainer", "two\nlines"),
        ("maintainer", "\x1b[31m"),
        ("maintainer", "\u202eevil"),
        ("maintainer", "x" * 501),
        ("maintainer", "NAME"),
        ("email", "nobody"),
        ("email", "a@b"),
        ("email", "a@b.org, c@d.org"),
        ("email", "Ada <a@b.org>"),
        ("email", "a b@c.org"),
        ("email", "\N{CYRILLIC SMALL LETTER A}@b.org"),
        ("license", "MIT\tor so"),
        ("license", []),
        ("description", "\u2028"),
        ("descripton", "x"),
    ],
)
def test_what_no_manifest_takes_is_refused_at_its_place(
    fretc: Fretc, field: str, value: object
) -> None:
    table = {**WHOLE, field: value}
    project(table)  # type: ignore[arg-type]
    run = fretc("requirements/r1.fret", "--emit", "ros2-package")
    assert run.status == 2
    assert "F520" in run.err
    assert "--> requirements/fretc.toml:" in run.err
    assert not Path("build").exists()


def test_the_example_is_no_answer(fretc: Fretc) -> None:
    project(None)
    write("requirements/fretc.toml", EXAMPLE)
    assert "F520" in fretc("requirements/r1.fret", "--emit", "ros2-package").err


def test_a_new_project_has_the_table_to_fill_in(fretc: Fretc) -> None:
    assert fretc("init").status == 0
    text = Path("requirements/fretc.toml").read_text("utf-8")
    assert all(f"# {line}" in text for line in EXAMPLE.splitlines())
    assert fretc("check").status == 0
    write("fretc.toml", "")
    assert fretc("init", "other").status == 0
    assert not Path("other/requirements/fretc.toml").exists()


def test_a_text_of_another_kind_is_unfit() -> None:
    assert isinstance(attribution({"email": "x"}), InvalidField)
