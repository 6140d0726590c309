"""The address at which another program shows a log at a time."""

from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest

from compiler.files.log_viewer import host, link, mistake
from compiler.files.settings import Settings, settings
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from tests.command import write
from tests.each import each

FOXGLOVE = (
    "https://app.foxglove.dev/~/view?ds=remote-file&ds.url=https://logs.example.org/{log}"
    "&time={time}"
)
NS = 1_700_000_013_200_000_000
"""2023-11-14 22:13:33.2 UTC."""


def test_a_browser_reads_log_and_time_from_the_link() -> None:
    parts = urlsplit(link(FOXGLOVE, "runs/mission 4.mcap", NS))
    assert (parts.scheme, parts.netloc) == ("https", host(FOXGLOVE)) == ("https", parts.hostname)
    assert parse_qs(parts.query) == {
        "ds": ["remote-file"],
        "ds.url": ["https://logs.example.org/runs/mission 4.mcap"],
        "time": ["2023-11-14T22:13:33.200000000Z"],
    }


def test_the_time_is_also_in_seconds_and_in_nanoseconds() -> None:
    address = "https://a.org/{log}?t={seconds}#{ns}"
    assert link(address, "a", NS + 7) == f"https://a.org/a?t=1700000013.200000007#{NS + 7}"


def test_a_name_of_a_log_stays_one_value() -> None:
    for name in ("a&time=0", "a#b", "a?b", "{ns}", "\u00fc", '"><script>', "javascript:alert(1)"):
        query = parse_qs(urlsplit(link("https://a.org/?log={log}&x=1", name, NS)).query)
        assert query == {"log": [name], "x": ["1"]}, name


def test_a_time_before_1970_or_after_9999_has_no_link() -> None:
    assert [link(FOXGLOVE, "a", ns) for ns in (-1, 10**21)] == ["", ""]


SCHEME = "must begin with `https://` and a host, and contain no spaces"
BRACES = "must have no braces other than `{log}`, `{time}`, `{seconds}`, `{ns}`"


@each(
    "case",
    [
        (FOXGLOVE, ""),
        ("https://a.org:8443/{log}", ""),
        ("javascript:alert('{log}')", SCHEME),
        ("http://a.org/{log}", SCHEME),
        ("HTTPS://a.org/{log}", SCHEME),
        ("https://{log}", SCHEME),
        ("https://user:word@a.org/{log}", SCHEME),
        ("https://a.org", SCHEME),
        ("https://a.org/{log}\n", SCHEME),
        ('https://a.org/"{log}', SCHEME),
        ("https://a.org/{log}{name}", BRACES),
        ("https://a.org/{log}{", BRACES),
        ("https://a.org/{{log}}", BRACES),
        ("https://a.org/{time}", "must contain `{log}`"),
        ("https://a.org/{log}" + "x" * 2_000, "must be an address of up to 2000 characters"),
        (3, "must be an address of up to 2000 characters"),
    ],
)
def test_only_https_addresses_with_known_placeholders_are_accepted(
    case: tuple[object, str],
) -> None:
    address, message = case
    assert mistake(address) == message


def test_the_settings_have_the_address_or_say_what_is_wrong_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write("fretc.toml", f'viewer = "{FOXGLOVE}"\n')
    found = settings(".")
    assert isinstance(found, Settings)
    assert found.viewer == FOXGLOVE
    write("fretc.toml", "viewer = \"javascript:alert('{log}')\"\n")
    found = settings(".")
    assert isinstance(found, Diagnostic)
    assert render(found) == (
        f"F520 `viewer` {SCHEME}\n"
        "  --> fretc.toml:1:1\n"
        "   | viewer = \"javascript:alert('{log}')\"\n"
        "   | ^^^^^^\n"
        'help: write one such as `viewer = "https://app.foxglove.dev/~/view?ds=remote-file'
        '&ds.url=https://logs.example.org/{log}&time={time}"`'
    )
