"""`allowed_signers`: whose keys count, under which names."""

import re
from pathlib import Path

import pytest

from fretc.attestation.signers import Signers, read, trusted
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from tests import keys

ADA = keys.make("ed25519")
KEY = keys.public(ADA)
BLOB = KEY.split()[1]


def listed(folder: Path, text: str) -> Signers:
    signers = read(put(folder, text))
    assert isinstance(signers, Signers)
    return signers


def put(folder: Path, text: str) -> str:
    (folder / "allowed_signers").write_text(text, encoding="utf-8")
    return str(folder / "allowed_signers")


def test_a_line_names_people_and_a_key(tmp_path: Path) -> None:
    text = f'# who may sign\n\nada@x.org {KEY}\n  "A. Lovelace,*@y.org,!eve@y.org"\t{KEY} me\n'
    first, second = listed(tmp_path, text).signers
    assert first.principals == ("ada@x.org",)
    assert second.principals == ("A. Lovelace", "*@y.org", "!eve@y.org")
    assert first.key == second.key
    assert first.name == f"ada@x.org ({first.key.fingerprint})"


@pytest.mark.parametrize(
    ("pattern", "name", "fits"),
    [
        ("ada", "ada", True),
        ("ada", "Ada", False),
        ("ada", "ada ", False),
        ("ada", "adam", False),
        ("ada", "Ada <ada>", False),
        ("a?a", "ada", True),
        ("*", "anybody", True),
        ("[a]da", "ada", False),
        ("[a]da", "[a]da", True),
        ("*@x.org,!eve@x.org", "ada@x.org", True),
        ("*@x.org,!eve@x.org", "eve@x.org", False),
        ("!eve@x.org", "ada@x.org", False),
    ],
)
def test_a_name_fits_as_a_whole(tmp_path: Path, pattern: str, name: str, fits: bool) -> None:
    (signer,) = listed(tmp_path, f'"{pattern}" {KEY}\n').signers
    assert signer.goes_by(name) is fits


@pytest.mark.parametrize(
    ("options", "count"),
    [
        ('namespaces="fretc"', 1),
        ('namespaces="git,fretc"', 1),
        ('namespaces="f*"', 1),
        ('namespaces="git"', 0),
        ('NAMESPACES="git,file"', 0),
        ('namespaces=""', 0),
    ],
)
def test_a_key_for_something_else_is_none_of_ours(tmp_path: Path, options: str, count: int) -> None:
    signers = listed(tmp_path, f"ada {options} {KEY}\n")
    assert (len(signers.signers), signers.remarks) == (count, ())


@pytest.mark.parametrize(
    "line",
    [
        "ada cert-authority ssh-ed25519 BLOB",
        'ada valid-before="20200101" ssh-ed25519 BLOB',
        'ada namespaces="fretc",valid-after="20300101" ssh-ed25519 BLOB',
        "ada sk-ssh-ed25519@openssh.com BLOB",
        "ada ssh-dss BLOB",
    ],
)
def test_a_key_with_a_condition_that_is_not_known_does_not_count_and_that_is_said(
    tmp_path: Path, line: str
) -> None:
    signers = listed(tmp_path, f"eve {KEY}\n{line.replace('BLOB', BLOB)}\n")
    (remark,) = signers.remarks
    assert [signer.principals for signer in signers.signers] == [("eve",)]
    assert (remark.code, remark.severity) == (Code.BAD_SIGNERS, Severity.WARNING)
    assert remark.span is not None
    assert remark.span.line == 2


@pytest.mark.parametrize(
    "line",
    ["ada", "ssh-ed25519 BLOB", '"ada ssh-ed25519 BLOB', "ada ssh-ed25519 AAAAC3NzaC1lZDI1NTE5",
     "ada ssh-ed25519 AAAA", "ada ecdsa-sha2-nistp256 BLOB", "ada x=y ssh-ed25519 BLOB",
     'ada namespaces="a"b ssh-ed25519 BLOB'],
)  # fmt: skip
def test_another_line_is_told_with_its_place(tmp_path: Path, line: str) -> None:
    signers = read(put(tmp_path, f"# list\n{line.replace('BLOB', BLOB)}\n"))
    assert isinstance(signers, Diagnostic)
    assert signers.code is Code.BAD_SIGNERS
    assert signers.span is not None
    assert signers.span.line == 2


def test_who_is_trusted_is_a_public_key_or_a_list(tmp_path: Path) -> None:
    (one,) = listed(tmp_path, f"ada {KEY}\n").signers
    (tmp_path / "id.pub").write_text(f"{KEY} me\n", encoding="utf-8")
    for name, principals in (("id.pub", ()), ("allowed_signers", ("ada",))):
        signers = trusted(str(tmp_path / name))
        assert isinstance(signers, Signers)
        assert [(s.principals, s.key) for s in signers.signers] == [(principals, one.key)]
    diagnostic = trusted(put(tmp_path, "ssh-ed25519 AAAA\n"))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code is Code.BAD_KEY


@pytest.mark.slow
def test_a_costly_list_is_read_soon(tmp_path: Path) -> None:
    """Stars and quotes, each of which a naive matcher would try everywhere."""
    star = "*a" * 20000
    (signer,) = listed(tmp_path, f'"{star}" {KEY}\n').signers
    assert not signer.goes_by("a" * 300 + "b")
    for text in ("ada " + '""' * 30000, "a " * 30000, "ada " + 'x="' * 20000, '"' * 60000):
        signers = read(put(tmp_path, f"{text}\n"))
        assert isinstance(signers, Diagnostic)
        assert re.fullmatch("F548|F930", signers.code.number)
