"""`fretc sbom`: what the installed tool consists of."""

import json
from importlib.metadata import distribution

import pytest
from cyclonedx.schema import OutputFormat, SchemaVersion
from cyclonedx.validation import make_schemabased_validator

from fretc.attestation.sbom import closure
from fretish.diagnostics import extras
from tests.command import Fretc


@pytest.mark.slow
def test_the_bill_has_its_schema_its_libraries_and_the_same_bytes_each_time(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each library that is needed with its version, and no tool of developers."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")
    run = fretc("sbom")
    assert (run.status, run.err) == (0, "")
    assert fretc("sbom").out == run.out
    validator = make_schemabased_validator(OutputFormat.JSON, SchemaVersion.V1_6)
    assert validator.validate_str(run.out) is None
    bom = json.loads(run.out)
    assert bom["specVersion"] == "1.6"
    assert bom["metadata"]["component"]["name"] == "fretc"
    assert bom["metadata"]["component"]["licenses"] == [{"license": {"id": "GPL-3.0-or-later"}}]
    versions = {one["name"]: one["version"] for one in bom["components"]}
    for name in ("click", "numpy", "spottl", "mcap", "markupsafe", "cryptography"):
        assert versions[name] == distribution(name).version
    assert not versions.keys() & {"pytest", "mypy", "ruff", "hypothesis", "fretc"}
    listed = {one["ref"]: one.get("dependsOn", []) for one in bom["dependencies"]}
    by_name = {one["name"]: one["bom-ref"] for one in bom["components"]}
    assert by_name["markupsafe"] in listed[by_name["jinja2"]]


@pytest.mark.slow
def test_the_closure_is_closed_and_reached_from_the_root() -> None:
    needs = closure()
    assert all(set(needed) <= needs.keys() for needed in needs.values())
    reached, waiting = set(), ["fretc"]
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting.extend(needs[name])
    assert reached == needs.keys()


def test_without_its_library_it_says_what_to_install(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    run = fretc("sbom")
    assert run.status == 2
    assert run.err.startswith(
        "F908 a bill of materials needs `cyclonedx`, `packageurl` and `packaging`\n"
    )
