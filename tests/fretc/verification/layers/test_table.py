"""The table of layers and provers: complete, and all that a run asks."""

import sys
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from types import ModuleType

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import PROVERS, Layer, Proof, not_checked, proof
from compiler.project.folder import load
from compiler.project.project import Project
from compiler.targets.python import monitor
from fretc.verification import verify
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.layers.request import Request
from fretc.verification.layers.table import TABLE, Method
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc, write


def test_the_table_has_each_layer_and_each_prover_once() -> None:
    assert sorted(method.name for method in TABLE) == sorted((*Layer, *PROVERS))


@pytest.mark.parametrize("method", TABLE, ids=lambda method: method.name)
def test_the_module_of_a_row_proves(method: Method) -> None:
    name = method.name.replace("-", "_")
    assert callable(import_module(f"fretc.verification.layers.{name}").prove)


@pytest.fixture
def project(fretc: Fretc) -> Project:
    """Of two requirements."""
    sentence = "the sw shall always satisfy p"
    return load([write("r1.fret", sentence), write("r2.fret", sentence)])


def add(
    monkeypatch: pytest.MonkeyPatch, *methods: Method, mistake: Diagnostic | None = None
) -> None:
    """Give the table more rows, whose modules know no requirements, or find a mistake."""
    for method in methods:
        module = ModuleType(method.name)
        module.prove = partial(_prove, method, mistake)  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, f"fretc.verification.layers.{method.name}", module)
    monkeypatch.setattr(verify, "TABLE", (*TABLE, *methods))


def _prove(
    method: Method,
    mistake: Diagnostic | None,
    requirements: Sequence[FormalizedRequirement],
    project: Project,
    request: Request,
) -> list[Proof] | Diagnostic:
    ids = [requirement.id for requirement in requirements]
    names = ids if method.of_requirement else ["+".join(ids)]
    return mistake or [
        proof(name, Layer.AGENT, method.claim, not_checked("new"), method.name) for name in names
    ]


def asked(project: Project, *provers: str) -> list[tuple[str, str]] | Diagnostic:
    proofs = verify.prove(project, Request((), CallLimits(), provers=provers))
    if isinstance(proofs, Diagnostic):
        return proofs
    return [(line.engine, line.requirement) for line in proofs]


def test_a_row_and_a_module_are_a_new_method(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    single = Method("single", "of each", of_requirement=True)
    add(monkeypatch, Method("whole", "of all"), single)
    assert asked(project) == []
    assert asked(project, "single") == [("single", "r1"), ("single", "r2")]
    assert asked(project, "whole", "single") == [
        ("single", "r1"),
        ("single", "r2"),
        ("whole", "r1+r2"),
    ]


def test_a_mistake_in_a_text_ends_the_run(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    mistake = Diagnostic(Code.BAD_PERCEPT, "`x` cannot be a percept")
    add(monkeypatch, Method("broken", "nothing"), mistake=mistake)
    assert asked(project, "broken") == mistake


def test_monitors_are_refused_only_where_a_layer_steps_them(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    refusal = Diagnostic(Code.NOT_EXPRESSIBLE, "no monitor can express it")
    monkeypatch.setattr(monitor, "refuse", lambda requirement: refusal)
    for method in TABLE:
        layers = [layer for layer in Layer if layer == method.name]
        request = Request(layers, CallLimits(), provers=[method.name])
        ids = [requirement.id for requirement in project.formalized]
        expected = dict.fromkeys(ids, refusal) if method.needs_monitor else {}
        assert verify.refusals(project, request) == expected, method.name
    assert {method.name for method in TABLE if method.needs_monitor} == {
        "monitor",
        "loop",
        "bounds",
    }
