"""Logs in a store: a real S3 server on this machine, which moto plays."""

import os
import shutil
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import boto3  # type: ignore[import-untyped]
import fsspec
import pytest

from fretc.audit.log_paths import logs
from fretc.audit.selection.dates import is_older
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc, untimed, write
from tests.effort import some
from tests.fretc.logs import logs as recordings

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::DeprecationWarning")]
ROBOT = (
    '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\n[proposition.low]\nexpr = "x < 20"\n'
)
Put = Callable[..., None]


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    from moto.server import ThreadedMotoServer  # half a second

    running = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    running.start()
    host, port = running.get_host_and_port()
    yield f"http://{host}:{port}"
    running.stop()


@pytest.fixture(scope="module")
def client(server: str) -> Iterator[Any]:
    made = boto3.client(
        "s3",
        endpoint_url=server,
        aws_access_key_id="ada",
        aws_secret_access_key="of-the-robots",
        region_name="us-east-1",
    )
    made.create_bucket(Bucket="fleet")
    yield made
    made.close()


@pytest.fixture
def bucket(server: str, client: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Put]:
    """An empty bucket `fleet`; its keys are in the environment, as s3fs looks for them."""
    for name in [name for name in os.environ if name.startswith(("AWS_", "FSSPEC_"))]:
        monkeypatch.delenv(name)
    for name, value in {
        "AWS_ENDPOINT_URL": server,
        "AWS_ACCESS_KEY_ID": "ada",
        "AWS_SECRET_ACCESS_KEY": "of-the-robots",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_EC2_METADATA_DISABLED": "true",
    }.items():
        monkeypatch.setenv(name, value)

    def put(*keys: str, data: bytes = b"") -> None:
        for key in keys:
            client.put_object(Bucket="fleet", Key=key, Body=data)

    fsspec.filesystem("s3").clear_instance_cache()
    yield put
    fsspec.filesystem("s3").clear_instance_cache()
    for one in client.list_objects_v2(Bucket="fleet").get("Contents", []):
        client.delete_object(Bucket="fleet", Key=one["Key"])


def code(path: str) -> Code:
    found = logs([path])
    assert isinstance(found, Diagnostic)
    return found.code


def test_a_prefix_stands_for_the_logs_below_it_in_the_order_of_their_names(bucket: Put) -> None:
    bucket("runs/b.mcap", "runs/a/2.mcap", "runs/a/1.mcap", "runs/notes.txt", "runs/x.fretc.mcap")
    bucket("runs-of-others/c.mcap", "runs/old.bag")
    assert logs(["s3://fleet/runs/"]) == [
        "s3://fleet/runs/a/1.mcap",
        "s3://fleet/runs/a/2.mcap",
        "s3://fleet/runs/b.mcap",
        "s3://fleet/runs/old.bag",
    ]
    assert logs(["s3://fleet/runs/b.mcap", "s3://fleet/runs/", "s3://fleet/"]) == [
        "s3://fleet/runs/b.mcap",
        "s3://fleet/runs/a/1.mcap",
        "s3://fleet/runs/a/2.mcap",
        "s3://fleet/runs/old.bag",
        "s3://fleet/runs-of-others/c.mcap",
    ]


def test_a_pattern_stands_for_what_it_matches(bucket: Put) -> None:
    bucket("runs/b.mcap", "runs/a/2.mcap", "runs/a/deep/1.mcap", "runs/a/n.txt", "run[1].mcap")
    assert logs(["s3://fleet/runs/?.mcap"]) == ["s3://fleet/runs/b.mcap"]
    assert logs(["s3://fleet/runs/**/*.mcap"]) == [
        "s3://fleet/runs/a/2.mcap",
        "s3://fleet/runs/a/deep/1.mcap",
        "s3://fleet/runs/b.mcap",
    ]
    assert logs(["s3://fleet/run[1].mcap"]) == ["s3://fleet/run[1].mcap"]


def test_a_store_without_such_a_log_is_told(bucket: Put) -> None:
    bucket("runs/notes.txt")
    assert code("s3://fleet/runs/") is Code.NO_SUCH_FILE
    assert code("s3://fleet/none/") is Code.NO_SUCH_FILE
    assert code("s3://fleet/*.mcap") is Code.NO_SUCH_FILE
    assert code("s3://another/") in (Code.NO_SUCH_FILE, Code.UNREADABLE)
    assert code("s3:///") is Code.UNREADABLE


@pytest.fixture
def robot(fretc: Fretc, bucket: Put) -> Fretc:
    write("requirements/r1.fret", "the robot shall always satisfy low")
    write("requirements/bindings.toml", ROBOT)
    Path("local").mkdir()
    for name, most in (("a", 5), ("b", 30), ("c", 12)):
        values = [recordings.number(i, recordings.S + i * 100 * recordings.MS) for i in range(most)]
        recordings.write(Path(f"local/{name}.mcap"), values)
        bucket(f"night/{name}.mcap", data=Path(f"local/{name}.mcap").read_bytes())
    return fretc


@pytest.mark.confined
@pytest.mark.parametrize("jobs", some(["2", "1"], 2))
def test_an_audit_of_a_prefix_is_that_of_its_files(robot: Fretc, jobs: str) -> None:
    there = robot("audit", "s3://fleet/night/", "--jobs", jobs, "-o", "there.json")
    assert there.status == 1, there.err
    here = robot("audit", "local", "--jobs", jobs, "-o", "here.json")
    evidence = Path("there.json").read_text().replace("s3://fleet/night/", "local/")
    assert evidence == Path("here.json").read_text()
    assert (
        untimed(there.out).replace("s3://fleet/night/", "local/").splitlines()[:3]
        == untimed(here.out).splitlines()[:3]
    )


def test_a_log_that_cannot_be_read_is_no_data_and_no_other_is_lost(
    robot: Fretc, bucket: Put
) -> None:
    bucket("night/d.mcap", data=b"no log")
    run = robot("audit", "s3://fleet/night/", "-v")
    assert run.status == 2
    assert "F402" in run.err
    assert run.out.count("satisfied") == 3  # two runs, and the count
    assert "no data" in run.out


def test_a_log_in_a_store_has_the_date_of_its_recording(robot: Fretc) -> None:
    start = 1_700_000_000  # in November 2023
    values = [recordings.number(i, (start + i) * recordings.S) for i in range(3)]
    recordings.write(Path("dated.mcap"), values)
    with fsspec.open("s3://fleet/night/dated.mcap", "wb") as file:
        file.write(Path("dated.mcap").read_bytes())
    dated, simulated = "s3://fleet/night/dated.mcap", "s3://fleet/night/a.mcap"
    before, after = (datetime.fromtimestamp(start + shift, UTC) for shift in (0, 1))
    assert not is_older(dated, before)
    assert is_older(dated, after)
    assert not is_older(simulated, after)  # by its change, which is now
    assert is_older(simulated, datetime(9999, 1, 1, tzinfo=UTC))
    run = robot("audit", "s3://fleet/night/", "--since", "1d")
    assert "3 of 4 logs: 1 are from before" in run.err


def test_no_file_makes_a_store_be_opened(robot: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    assert robot("audit", "s3://fleet/night/").status == 1
    shutil.rmtree("local")
    monkeypatch.delenv("AWS_ENDPOINT_URL")  # nothing could be reached now
    checked = robot("verify-evidence", "build/evidence")
    assert checked.status == 3
    assert "F921" in checked.err
