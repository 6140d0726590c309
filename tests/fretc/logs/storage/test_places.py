"""What evidence of somebody else can make us open."""

from pathlib import Path

import pytest

from fretc.logs.storage.places import AllowedLocations


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here/runs").mkdir(parents=True)
    (tmp_path / "data").mkdir()
    (tmp_path / "here/link.mcap").symlink_to("/etc/passwd")
    (tmp_path / "here/way").symlink_to(tmp_path / "data")
    monkeypatch.chdir(tmp_path / "here")


@pytest.mark.parametrize(
    "place",
    [
        "a.mcap",
        "runs/a.mcap",
        "./runs/../a.mcap",
        "https://host/a.mcap",
        "HTTPS://host:8443/runs/a.mcap?part=1",
    ],
)
def test_files_below_the_present_folder_and_https_are_opened(place: str) -> None:
    assert AllowedLocations().refusal(place) == ""


@pytest.mark.parametrize(
    "place",
    [
        "/etc/passwd",
        "../data/a.mcap",
        "runs/../../data/a.mcap",
        "link.mcap",
        "way/a.mcap",
        "http://host/a.mcap",
        "http://169.254.169.254/latest/meta-data/",
        "file:///etc/passwd",
        "ftp://host/a.mcap",
        "s3://bucket/a.mcap",
        "ssh://host/a.mcap",
        "github://org:repo@main/a.mcap",
        "local:///etc/passwd",
        "simplecache::https://host/a.mcap",
        "https://host/a::file:///etc/passwd",
        "filecache::ssh://host/a.mcap",
        "zip://a.mcap::https://host/a.zip",
        "reference://::https://host/a.json",
        "https:///a.mcap",
        "https://[::1",
    ],
)
def test_nothing_else_is(place: str) -> None:
    assert AllowedLocations().refusal(place) != ""


@pytest.mark.parametrize(
    ("named", "place", "opened"),
    [
        ("../data", "../data/a.mcap", True),
        ("../data", "way/a.mcap", True),
        ("../data", "../data/../other/a.mcap", False),
        ("../dat", "../data/a.mcap", False),
        ("s3://bucket/runs", "s3://bucket/runs/a.mcap", True),
        ("s3://bucket/runs/", "s3://bucket/runs/a.mcap", True),
        ("s3://bucket/runs/a.mcap", "s3://bucket/runs/a.mcap", True),
        ("s3://bucket/run", "s3://bucket/runs/a.mcap", False),
        ("s3://bucket/runs", "s3://bucket/runs/../secret", False),
        ("s3://bucket/runs", "s3://bucket/runs/%2e%2e/secret", False),
        ("s3://bucket/runs", "s3://bucket/runs/::file:///etc/passwd", False),
        ("http://host", "http://host.evil/a.mcap", False),
        ("http://host", "http://host@evil/a.mcap", False),
        ("http://host", "http://host:1/a.mcap", False),
        ("simplecache::s3://bucket/", "simplecache::s3://bucket/a.mcap", True),
    ],
)
def test_what_the_user_names_is_opened_and_nothing_beside_it(
    named: str, place: str, opened: bool
) -> None:
    assert (AllowedLocations((named,)).refusal(place) == "") is opened


@pytest.mark.parametrize("place", ["https://host/a.mcap", "s3://bucket/a.mcap"])
def test_offline_no_server_is_asked(place: str) -> None:
    assert AllowedLocations(("s3://bucket/",), offline=True).refusal(place) != ""
    assert AllowedLocations(offline=True).refusal("a.mcap") == ""
