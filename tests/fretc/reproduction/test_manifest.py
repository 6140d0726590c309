"""Manifests of runs that are folders: each of their files is named."""

import hashlib
from pathlib import Path

import pyarrow
import pyarrow.parquet
import pytest

from fretc.audit.evidence.schema import SCHEMA, BindingsRecord, EvidenceDocument
from fretc.logs.storage.folders import of_all
from fretc.reproduction.manifest import Manifest, matches, read
from tests.fretc.audit.results import result
from tests.fretc.logs.storage.test_folders import run


def listed(folder: Path) -> dict[str, str]:
    return {
        f"logs/{folder.name}/{path.name}": hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.iterdir())
    }


def wrong(folder: Path, logs: dict[str, str]) -> list[str]:
    hashes = {path.name: listed(folder)[f"logs/run/{path.name}"] for path in folder.glob("*.mcap")}
    one = result(run="logs/run", hashes={"log": of_all(dict(sorted(hashes.items())))})
    document = EvidenceDocument(SCHEMA, "", BindingsRecord("", ""), (), (one,))
    file = folder.parent / "manifest"
    file.write_text("".join(f"{sha}  {path}\n" for path, sha in logs.items()))
    manifest = read(str(file))
    assert isinstance(manifest, Manifest)
    runs = matches(document, manifest, {"logs/run": str(folder)})
    return [reason for match in runs for one in match.differences for reason in one.reasons]


def test_a_manifest_of_all_files_of_a_folder_is_matched(tmp_path: Path) -> None:
    folder = run(tmp_path)
    logs = listed(folder)
    assert wrong(folder, logs) == []
    assert wrong(folder, {path: logs[path] for path in logs if path.endswith(".mcap")}) == []


@pytest.mark.parametrize("name", ["run_0.mcap", "metadata.yaml"])
def test_another_file_in_a_folder_is_found(tmp_path: Path, name: str) -> None:
    folder = run(tmp_path)
    reasons = wrong(folder, {**listed(folder), f"logs/run/{name}": "0" * 64})
    assert reasons == [f"the manifest has another hash for `logs/run/{name}`"]


def test_a_file_of_a_folder_that_is_not_named_is_found(tmp_path: Path) -> None:
    folder = run(tmp_path)
    logs = listed(folder)
    del logs["logs/run/run_1.mcap"]
    assert wrong(folder, logs) == ["the manifest does not name `logs/run/run_1.mcap`"]
    assert wrong(folder, {**listed(folder), "logs/run/run_9.mcap": "0" * 64}) == [
        "the manifest names it, but the evidence has no result for it"
    ]


def test_the_runs_of_a_table_are_those_of_its_one_file_and_none_is_left_out(tmp_path: Path) -> None:
    file = tmp_path / "f.parquet"
    pyarrow.parquet.write_table(pyarrow.table({"episode_index": [0, 1], "t": [0.0, 0.0]}), file)
    sha = hashlib.sha256(file.read_bytes()).hexdigest()
    manifest = Manifest(str(tmp_path / "manifest"), {"logs/f.parquet": sha})

    def differences(*numbers: int, claim: str = sha) -> dict[str, int]:
        runs = [f"logs/f.parquet#{number}" for number in numbers]
        results = tuple(result(run=run, hashes={"log": claim}) for run in runs)
        document = EvidenceDocument(SCHEMA, "", BindingsRecord("", ""), (), results)
        places = {run: f"{file}#{number}" for run, number in zip(runs, numbers, strict=True)}
        return {each.run: len(each.differences) for each in matches(document, manifest, places)}

    assert differences(0, 1) == {"logs/f.parquet#0": 0, "logs/f.parquet#1": 0}
    assert differences(1) == {"logs/f.parquet#1": 0, "logs/f.parquet#0": 1}
    file.write_bytes(file.read_bytes() + b"x")
    assert differences(1)["logs/f.parquet#1"] == 1
