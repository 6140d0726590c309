"""`fretc sign`, `fretc lock --key` and `verify-evidence --signed-by`, as their users meet them."""

import base64
import io
import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fretc.attestation.statement import TYPE
from fretish.diagnostics import extras
from tests import keys
from tests.command import Fretc, made_once, write
from tests.effort import FULL
from tests.fretc.commands.test_verify_evidence import BINDINGS, R1, log

R2 = "whenever q the sw shall within 2 ticks satisfy q"
BY = ("--role", "engineer", "--comment", "looked at", "--accept-violations", "--date", "2026-09-01")
WAIVERS = "".join(
    f"""[{id}]
verdict = "violated"
reason = "the brake is being replaced"
by = "{by}"
role = "engineer"
granted = "2026-01-01"
expires = "2026-12-31"
"""
    for id, by in (("r1", "Ada"), ("r2", "Bob"))
)
EVIDENCE, LOCK = "build/evidence.json", "requirements/fretc.lock"
SIGNERS = "requirements/allowed_signers"


@pytest.fixture
def project(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Fretc:
    """Two requirements, two logs that were audited, one of them violated; keys of Ada and Bob."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")  # 2026-09-21

    def make() -> None:
        write("requirements/r1.fret", R1)
        write("requirements/r2.fret", R2)
        write("requirements/bindings.toml", BINDINGS)
        log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
        log("logs/bad.mcap", 0, 1.5, 0, 0, 0, 0)
        assert fretc("audit", "logs", "-o", "build/evidence.json").status == 1
        for name in ("ada", "bob"):
            keys.written(name)

    made_once("a project to sign", make)
    return fretc


def trust(*names: str) -> None:
    write(SIGNERS, "".join(keys.line(name.capitalize(), name) for name in names))


def envelopes(path: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in Path(f"{path}.intoto.jsonl").read_text().splitlines()]


def payload(envelope: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(base64.b64decode(envelope["payload"]))
    return found


def report(project: Fretc) -> tuple[int, dict[str, Any], str]:
    run = project("report", "--json", "r.json", "--markdown", "r.md")
    return run.status, json.loads(Path("r.json").read_text()), run.err


def signed(told: dict[str, Any]) -> dict[str, tuple[str, str]]:
    """Each thing → the word of its mark, and what is said of it."""
    return {
        f"{one['kind']} {one['name']}": (one["signature"]["mark"]["word"], one["signature"]["text"])
        for one in told["signatures"]["signed"]
    }


# Evidence --------------------------------------------------------------------------------------


def test_signing_says_what_is_signed(project: Fretc) -> None:
    run = project("sign", EVIDENCE, "--key", "ada")
    assert (run.status, run.out) == (0, "")
    fingerprint = envelopes(EVIDENCE)[0]["signatures"][0]["keyid"]
    assert run.err == (
        "evidence build/evidence.json: 2 satisfied, 1 vacuous, 1 violated\n"
        "  r1 is violated in logs/bad.mcap\n"
        "wrote build/evidence.json.intoto.jsonl\n"
        f"signed with 256 {fingerprint} (ED25519)\n"
    )


def test_the_statement_binds_evidence_logs_requirements_monitors_and_verdicts(
    project: Fretc,
) -> None:
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    (envelope,) = envelopes(EVIDENCE)
    told = payload(envelope)
    evidence = json.loads(Path(EVIDENCE).read_text())
    hashes = {one["run"]: one["hashes"]["log"] for one in evidence["results"]}
    named = {one["name"]: one["digest"]["sha256"] for one in told["subject"]}
    assert (told["_type"], told["predicateType"]) == (TYPE, "urn:fretc:evidence:1")
    assert named.keys() == {"evidence:evidence.json", "log:logs/good.mcap", "log:logs/bad.mcap"}
    assert all(named[f"log:{run}"] == sha for run, sha in hashes.items())
    said = told["predicate"]
    assert set(said["tool"]) == {"fretc", "edition", "python"}
    verdicts = {one["id"]: one["verdicts"] for one in said["requirements"]}
    assert [(id, run, word) for id, those in verdicts.items() for run, word in those] == [
        ("r1", "logs/bad.mcap", "violated"),
        ("r1", "logs/good.mcap", "satisfied"),
        ("r2", "logs/bad.mcap", "vacuous"),
        ("r2", "logs/good.mcap", "satisfied"),
    ]
    for one in said["requirements"]:
        assert {"sentence", "bindings", "monitor", "clock"} <= one["rests_on"].keys()


def test_evidence_stands_for_whoever_trusts_the_key_and_for_nobody_else(project: Fretc) -> None:
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    fingerprint = envelopes(EVIDENCE)[0]["signatures"][0]["keyid"]
    good = project("verify-evidence", "--signed-by", "ada.pub")
    assert (good.status, good.err) == (0, f"build/evidence.json is signed by {fingerprint}\n")
    other = project("verify-evidence", "--signed-by", "bob.pub")
    assert (other.status, other.out) == (1, ""), "nothing is opened that nobody has vouched for"
    assert other.err.startswith("F558 `build/evidence.json` is not signed as `bob.pub` asks for: ")
    trust("ada", "bob")
    assert project("verify-evidence", "--signed-by", SIGNERS).status == 0


def test_a_project_names_no_key_that_the_user_trusts(project: Fretc) -> None:
    """The list of the project counts for its report; who asks for a key asks for that one."""
    trust("bob")
    assert project("sign", EVIDENCE, "--key", "bob").status == 0
    assert signed(report(project)[1])["evidence build/evidence.json"][0] == "signed"
    assert project("verify-evidence", "--signed-by", "ada.pub").status == 1


def test_evidence_that_nobody_has_signed_is_not_signed(project: Fretc) -> None:
    run = project("verify-evidence", "--signed-by", "ada.pub")
    assert run.status == 1
    assert "asks for: nobody signed it\n" in run.err


@settings(
    max_examples=25 if FULL else 10, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_evidence_with_another_byte_is_not_signed(project: Fretc, data: st.DataObject) -> None:
    """Of any log, verdict, hash or number."""
    if not Path(f"{EVIDENCE}.intoto.jsonl").exists():
        assert project("sign", EVIDENCE, "--key", "ada").status == 0
    sound = Path(EVIDENCE).read_bytes()
    at = data.draw(st.integers(0, len(sound) - 1))
    changed = bytearray(sound)
    changed[at] ^= data.draw(st.integers(1, 127))
    try:
        Path(EVIDENCE).write_bytes(changed)
        assert project("verify-evidence", "--signed-by", "ada.pub").status in (1, 2)
    finally:
        Path(EVIDENCE).write_bytes(sound)


@pytest.mark.parametrize(
    "lie",
    [
        lambda told: told["predicate"]["requirements"][0]["verdicts"][0].__setitem__(
            1, "satisfied"
        ),
        lambda told: told["predicate"]["requirements"][0]["rests_on"].update(monitor="00"),
        lambda told: told["predicate"].update(more=1),
        lambda told: told["subject"][1]["digest"].update(sha256="0" * 64),
        lambda told: told["subject"].pop(),
    ],
)
def test_a_statement_that_says_something_else_than_its_evidence_does_not_count(
    project: Fretc, lie: Any
) -> None:
    """Anyone who signs may sign anything; only what fretc makes of this evidence is taken."""
    from fretc.attestation.keys import private_key, signed_envelope

    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    told = payload(envelopes(EVIDENCE)[0])
    lie(told)
    mine = private_key(Path("ada").read_bytes(), str)
    write(f"{EVIDENCE}.intoto.jsonl", signed_envelope(json.dumps(told).encode(), mine) + "\n")
    run = project("verify-evidence", "--signed-by", "ada.pub")
    assert run.status == 1
    assert "the signed statement differs from what the file contains" in run.err


def test_the_hash_of_a_log_is_no_hash_of_evidence(project: Fretc) -> None:
    """Evidence that names another evidence as its log vouches for no verdict of that."""
    from fretc.attestation.keys import private_key, signed_envelope

    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    told = payload(envelopes(EVIDENCE)[0])
    told["subject"] = [
        {"name": "evidence:x", "digest": {"sha256": "0" * 64}},
        {"name": "log:x", "digest": told["subject"][0]["digest"]},
    ]
    mine = private_key(Path("ada").read_bytes(), str)
    write(f"{EVIDENCE}.intoto.jsonl", signed_envelope(json.dumps(told).encode(), mine) + "\n")
    assert project("verify-evidence", "--signed-by", "ada.pub").status == 1
    trust("ada")
    assert signed(report(project)[1])["evidence build/evidence.json"][0] == "unauthenticated"


@pytest.mark.slow
def test_a_report_and_proofs_that_are_named_must_be_signed_too(project: Fretc) -> None:
    project("verify", "requirements/r1.fret", "--layer", "monitor")
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    names = [one["name"] for one in payload(envelopes(EVIDENCE)[0])["subject"]]
    assert "proofs:verification.json" in names
    by = ("verify-evidence", "--signed-by", "ada.pub")
    assert project(*by, "--verification", "build/verification.json").status == 0
    project("report")
    run = project(*by, "--report", "build/report.html")
    assert (run.status, "F558 `build/report.html`" in run.err) == (1, True)
    assert project("sign", "build/report.html", "--key", "ada").status == 0
    run = project(*by, "--report", "build/report.html")
    assert (run.status, "✔ report  the same, byte for byte" in run.out) == (0, True)


@pytest.mark.slow
def test_signatures_of_others_stay_and_ones_own_is_replaced(project: Fretc) -> None:
    for key in ("ada", "bob", "ada"):
        assert project("sign", EVIDENCE, "--key", key).status == 0
    assert len(envelopes(EVIDENCE)) == 2
    for key in ("ada", "bob"):
        assert project("verify-evidence", "--signed-by", f"{key}.pub").status == 0
    assert project("audit", "logs/good.mcap").status == 0
    assert project("verify-evidence", "--signed-by", "ada.pub").status == 1
    run = project("sign", EVIDENCE, "--key", "bob")
    assert "2 earlier signatures are removed" in run.err
    assert len(envelopes(EVIDENCE)) == 1


# Reviews and waivers ---------------------------------------------------------------------------


@pytest.mark.slow
def test_a_reviewer_signs_with_the_lock(project: Fretc) -> None:
    trust("ada", "bob")
    assert project("lock", "r1", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    assert project("lock", "r2", "--reviewer", "Bob", *BY).status == 0
    status, told, err = report(project)
    found = signed(told)
    assert (status, "F559" in err) == (0, False)
    assert found["review r1, by Ada"][0] == "signed"
    assert found["review r2, by Bob"] == ("unauthenticated", "nobody signed it")
    assert told["reviewed"] == (
        "2 of 2 requirements reviewed, all reviews are current. 1 of 2 is unauthenticated."
    )
    marks = {one["id"]: one["review"]["mark"] for one in told["requirements"]}
    assert marks["r1"]["kind"] == "satisfied"
    assert marks["r2"] == {"word": "reviewed", "glyph": "◔", "kind": "inconclusive",
                           "suspect": False}  # fmt: skip
    assert "review r2, by Bob: nobody signed it" in Path("r.md").read_text()


def test_the_page_says_whose_keys_count_as_ssh_keygen_prints_them(project: Fretc) -> None:
    trust("ada")
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    _, told, _ = report(project)
    fingerprint = envelopes(EVIDENCE)[0]["signatures"][0]["keyid"]
    assert told["signatures"]["file"] == SIGNERS
    assert told["signatures"]["signers"] == [f"Ada: 256 {fingerprint} (ED25519)"]
    assert ["signers", SIGNERS] in [[one["kind"], one["name"]] for one in told["manifest"]]
    page = Path("build/report.html").read_text()
    assert f"256 {fingerprint} (ED25519)" in page


def test_what_was_signed_by_another_than_its_reviewer_is_unauthenticated_and_told(
    project: Fretc,
) -> None:
    trust("ada", "bob")
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "bob").status == 0
    status, told, err = report(project)
    fingerprint = envelopes(LOCK)[0]["signatures"][0]["keyid"]
    why = f"signed by Bob ({fingerprint}), who is not Ada"
    assert signed(told)["review r1, by Ada"] == ("unauthenticated", why)
    assert f"F559 warning: the review of r1 is unauthenticated: {why}\n" in err
    assert status == 0


@pytest.mark.slow
def test_a_key_that_is_not_listed_authenticates_nobody(project: Fretc) -> None:
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    assert "but there is no list of signers" in signed(report(project)[1])["review r1, by Ada"][1]
    trust("bob")
    word, why = signed(report(project)[1])["review r1, by Ada"]
    assert word == "unauthenticated"
    assert why.startswith(
        "there is a signature, but its key is not in the list of signers (SHA256:"
    )


@pytest.mark.slow
def test_a_later_review_of_another_requirement_leaves_a_signature_in_force(
    project: Fretc,
) -> None:
    trust("ada", "bob")
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    assert project("lock", "r2", "--reviewer", "Bob", *BY, "--key", "bob").status == 0
    found = signed(report(project)[1])
    assert {found[name][0] for name in ("review r1, by Ada", "review r2, by Bob")} == {"signed"}
    assert len(envelopes(LOCK)) == 2


def test_a_review_that_is_made_again_has_to_be_signed_again(project: Fretc) -> None:
    trust("ada")
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    later = ("--role", "engineer", "--comment", "again", "--accept-violations")
    assert project("lock", "r1", "--reviewer", "Ada", *later).status == 0
    found = signed(report(project)[1])
    word, why = found["review r1, by Ada"]
    assert (word, why.endswith("signed it before it was changed")) == ("unauthenticated", True)
    assert found["review r2, by Ada"][0] == "signed"


def test_a_signature_that_is_taken_away_leaves_its_review_unauthenticated(
    project: Fretc,
) -> None:
    trust("ada")
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    Path(f"{LOCK}.intoto.jsonl").unlink()
    status, told, _ = report(project)
    assert (status, signed(told)["review r1, by Ada"][0]) == (0, "unauthenticated")


def test_waivers_are_signed_one_by_one(project: Fretc) -> None:
    trust("ada", "bob")
    write("requirements/waivers.toml", WAIVERS)
    run = project("sign", "requirements/waivers.toml", "--key", "ada")
    assert run.err.startswith("waiver of r1 by Ada until 2026-12-31: covers violated\nwrote ")
    _, told, _ = report(project)
    assert signed(told)["waiver r1, by Ada"][0] == "signed"
    assert signed(told)["waiver r2, by Bob"] == ("unauthenticated", "nobody signed it")
    longer = WAIVERS.replace("2026-12-31", "2027-12-31", 1)
    write("requirements/waivers.toml", longer)
    _, told, err = report(project)
    assert signed(told)["waiver r1, by Ada"][0] == "unauthenticated"
    assert "F559 warning: the waiver of r1 is unauthenticated" in err
    assert "There is no valid signature for the waiver of r1." in told["overall"]["sentences"]


def test_whoever_signs_signs_only_what_is_theirs(project: Fretc) -> None:
    write("requirements/waivers.toml", WAIVERS)
    path = "requirements/waivers.toml"
    unknown = project("sign", path, "--key", "ada")
    assert unknown.status == 2
    assert "names several people, and it is not clear who signs: `Ada`, `Bob`" in unknown.err
    assert project("sign", path, "--key", "ada", "--reviewer", "Eve").status == 2
    assert project("sign", path, "--key", "ada", "--reviewer", "Bob").status == 0
    assert [one["name"] for one in payload(envelopes(path)[0])["subject"]] == ["waiver:r2"]


# Forgery ---------------------------------------------------------------------------------------


def forge(path: str) -> None:
    """Another content under the signature that is there."""
    (envelope,) = envelopes(path)
    told = base64.b64decode(envelope["payload"]).replace(b'"python": "3', b'"python": "4')
    envelope["payload"] = base64.b64encode(told).decode()
    write(f"{path}.intoto.jsonl", json.dumps(envelope) + "\n")


@pytest.mark.slow
def test_a_signature_that_does_not_verify_is_red_everywhere(project: Fretc) -> None:
    assert project("audit", "logs/good.mcap").status == 0
    trust("ada")
    assert project("lock", "--reviewer", "Ada", *BY, "--key", "ada").status == 0
    assert report(project)[1]["overall"]["mark"]["word"] == "all shown"
    forge(LOCK)
    status, told, err = report(project)
    place = f"{LOCK}.intoto.jsonl:1"
    assert status == 2
    assert re.search(rf"F557 the signature of Ada \(SHA256:.*\n  --> {place}:1\n", err)
    assert signed(told)[f"signature {place}"][0] == "does not verify"
    assert signed(told)["review r1, by Ada"] == (
        "unauthenticated", "its signature does not verify")  # fmt: skip
    assert told["overall"]["mark"]["word"] == "does not verify"
    assert told["overall"]["headline"] == f"1 signature does not verify: {place}."
    assert "does not verify" in Path("build/report.html").read_text()
    assert f"✘ signature {LOCK}.intoto.jsonl\\:1: " in Path("r.md").read_text()


def test_a_forgery_beside_a_good_signature_fails_where_a_key_is_asked_for(
    project: Fretc,
) -> None:
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    good = Path(f"{EVIDENCE}.intoto.jsonl").read_text()
    forge(EVIDENCE)
    bad = Path(f"{EVIDENCE}.intoto.jsonl").read_text()
    for text in (bad, good + bad, bad + good):
        write(f"{EVIDENCE}.intoto.jsonl", text)
        run = project("verify-evidence", "--signed-by", "ada.pub")
        assert (run.status, "F557 the signature of SHA256:" in run.err) == (1, True)


def test_signatures_that_cannot_be_read_stop_the_report_and_are_never_overwritten(
    project: Fretc,
) -> None:
    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    broken = "<<<<<<< mine\n" + Path(f"{EVIDENCE}.intoto.jsonl").read_text()
    write(f"{EVIDENCE}.intoto.jsonl", broken)
    for args in (("report",), ("sign", EVIDENCE, "--key", "bob"),
                 ("verify-evidence", "--signed-by", "ada.pub")):  # fmt: skip
        run = project(*args)
        assert run.status == 2
        assert f"F556 the line is not a signed statement of fretc: " in run.err  # noqa: F541
        assert f"--> {EVIDENCE}.intoto.jsonl:1:1\n" in run.err
    assert Path(f"{EVIDENCE}.intoto.jsonl").read_text() == broken


# Keys and bad use ------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_passphrase_comes_from_the_environment(
    project: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    keys.written("eve", passphrase="open sesame")
    monkeypatch.setattr(sys, "stdin", io.StringIO("open sesame\n"))
    run = project("sign", EVIDENCE, "--key", "eve")
    assert (run.status, "there is no terminal to ask for it" in run.err) == (2, True)
    monkeypatch.setenv("FRETC_PASSPHRASE", "wrong")
    run = project("sign", EVIDENCE, "--key", "eve")
    assert (run.status, Path(f"{EVIDENCE}.intoto.jsonl").exists()) == (2, False)
    assert "F931 the key in `eve` cannot be used: the passphrase is wrong" in run.err
    monkeypatch.setenv("FRETC_PASSPHRASE", "open sesame")
    run = project("sign", EVIDENCE, "--key", "eve")
    assert (run.status, "sesame" in run.err) == (0, False)
    assert project("verify-evidence", "--signed-by", "eve.pub").status == 0


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("sign", EVIDENCE, "--key", "ada.pub"), "F931 the key in `ada.pub` cannot be used"),
        (("sign", EVIDENCE, "--key", "none"), "F901 there is no file `none`"),
        (("sign", "logs/good.mcap", "--key", "ada"), "F907 `logs/good.mcap` is nothing that fretc"),
        (("sign", "build/none.json", "--key", "ada"), "F901 there is no file `build/none.json`"),
        (("sign", "none.lock", "--key", "ada"), "F901 no requirement is reviewed"),
        (("sign", "none.html", "--key", "ada"), "F901 there is no file `none.html`"),
        (("sign", EVIDENCE, "--key", "ada", "--reviewer", "Ada"), "F907 `build/evidence.json` is"),
        (("verify-evidence", "--signed-by", "none.pub"), "F901 there is no file `none.pub`"),
        (("verify-evidence", "--signed-by", EVIDENCE), "F548 the line is not `NAME KEY-TYPE KEY`"),
    ],
)  # fmt: skip
def test_bad_use_is_told_and_writes_nothing(
    project: Fretc, args: tuple[str, ...], said: str
) -> None:
    before = sorted(Path().rglob("*"))
    run = project(*args)
    assert (run.status, f"\n{said}" in f"\n{run.err}") == (2, True), run.err
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize("text", ["{", "[]", '{"schema": 1}', '{"schema": "x", "schema": "y"}'])
def test_malformed_evidence_is_not_signed(project: Fretc, text: str) -> None:
    write(EVIDENCE, text)
    run = project("sign", EVIDENCE, "--key", "ada")
    assert (run.status, run.err.startswith("F503 ")) == (2, True)
    assert not Path(f"{EVIDENCE}.intoto.jsonl").exists()


def test_without_the_libraries_signatures_are_not_overlooked(
    project: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:

    assert project("sign", EVIDENCE, "--key", "ada").status == 0
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    for args in (("report",), ("sign", EVIDENCE, "--key", "ada"),
                 ("verify-evidence", "--signed-by", "ada.pub")):  # fmt: skip
        run = project(*args)
        assert run.status == 2
        assert run.err.startswith("F908 signatures need `securesystemslib` and `cryptography`\n")
    Path(f"{EVIDENCE}.intoto.jsonl").unlink()
    assert project("report").status == 0, "where nothing is signed nothing is needed"


def test_every_form_of_the_report_that_names_a_review_or_a_waiver_says_it_is_unauthenticated(
    project: Fretc,
) -> None:
    write("requirements/waivers.toml", WAIVERS)
    assert project("lock", "--reviewer", "Ada", *BY).status == 0
    forms = {"csv": "r.csv", "reqif": "r.reqif", "gsn": "r.yaml"}
    assert project("report", *(w for f, p in forms.items() for w in (f"--{f}", p))).status == 0
    assert "reviewed, unauthenticated" in Path("r.csv").read_text()
    assert "reviewed, unauthenticated" in Path("r.reqif").read_text()
    assert "(unauthenticated)" in Path("r.yaml").read_text()
