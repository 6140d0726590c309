"""Keys and envelopes: what verifies, and that nothing else does."""

import base64
import json
import subprocess
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric import dsa
from cryptography.hazmat.primitives.serialization import Encoding, PrivateFormat, PublicFormat
from hypothesis import given
from hypothesis import strategies as st

from compiler.files.checked_json import SchemaError
from fretc.attestation.keys import (
    PAYLOAD_TYPE,
    UnusableKeyError,
    private_key,
    public_key,
    read_envelope,
    signed_envelope,
)
from tests import keys
from tests.effort import some
from tests.programs import installed, needs

KINDS = ("ed25519", "nistp256", "nistp384", "nistp521", "rsa2048")
PAIRS = {kind: keys.make(kind) for kind in KINDS}
MINE, OTHER = PAIRS["ed25519"], keys.make("ed25519")


def nobody() -> str:
    raise AssertionError("the key has no passphrase")


def test_what_a_key_signs_verifies_with_its_public_key_and_no_other() -> None:
    for kind, key in PAIRS.items():
        mine = private_key(keys.private(key), nobody)
        one = read_envelope(signed_envelope(b"payload", mine))
        assert one.payload == b"payload"
        assert one.key_ids == (mine.public.fingerprint,)
        for other_kind, other in PAIRS.items():
            assert one.is_signed_by(public_key(keys.public(other))) is (kind == other_kind)
    assert not one.is_signed_by(public_key(keys.public(OTHER)))


ENVELOPE = signed_envelope(b'{"a": 1}', private_key(keys.private(MINE), nobody))


@given(st.data())
def test_any_byte_that_is_changed_breaks_the_signature(data: st.DataObject) -> None:
    content = json.loads(ENVELOPE)
    where = data.draw(st.sampled_from(["payload", "sig", "payloadType", "keyid"]))
    holder = content["signatures"][0] if where in ("sig", "keyid") else content
    is_packed = where in ("payload", "sig")
    raw = bytearray(base64.b64decode(holder[where]) if is_packed else holder[where].encode())
    raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 127))
    holder[where] = base64.b64encode(raw).decode() if is_packed else raw.decode("latin-1")
    assert not verifies(json.dumps(content))


@given(st.data())
def test_any_character_of_the_line_that_is_changed_breaks_it(data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(ENVELOPE) - 1))
    with_ = data.draw(st.characters(codec="utf-8").filter(lambda c: c != ENVELOPE[at]))
    line = f"{ENVELOPE[:at]}{with_}{ENVELOPE[at + 1 :]}"
    assert not verifies(line) or json.loads(line) == json.loads(ENVELOPE), "only white space"


def verifies(line: str) -> bool:
    try:
        return read_envelope(line).is_signed_by(public_key(keys.public(MINE)))
    except SchemaError:
        return False


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(payloadType="application/json"),
        lambda content: content.update(signatures=[]),
        lambda content: content.update(signatures=content["signatures"] * 2),
        lambda content: content.update(more=1),
        lambda content: content["signatures"][0].update(cert="x"),
        lambda content: content["signatures"][0].pop("keyid"),
        lambda content: content.update(payload=content["payload"].rstrip("=") + "\n"),
        lambda content: content.update(payload=content["payload"].replace("=", "")),
        lambda content: content.update(payload=7),
    ],
)
def test_an_envelope_of_another_form_is_refused(change: object) -> None:
    content = json.loads(ENVELOPE)
    assert callable(change)
    change(content)
    with pytest.raises(SchemaError):
        read_envelope(json.dumps(content))


def test_each_content_has_one_text() -> None:
    """The last digit before `==` has four bits that stand for nothing."""
    content = json.loads(ENVELOPE)
    sig = content["signatures"][0]["sig"]
    other = sig[:-3] + chr(ord(sig[-3]) + 1) + "=="
    assert base64.b64decode(other) == base64.b64decode(sig)
    content["signatures"][0]["sig"] = other
    with pytest.raises(SchemaError, match="must be base64"):
        read_envelope(json.dumps(content))


def test_a_name_that_stands_twice_is_refused() -> None:
    with pytest.raises(SchemaError, match="appears twice"):
        read_envelope(ENVELOPE.replace('{"payload"', '{"payload": "e30=", "payload"', 1))


def test_each_signature_of_an_envelope_counts_and_not_only_the_first() -> None:
    """Signed by two, one of them wrongly, in either order."""
    first, second = (private_key(keys.private(key), nobody) for key in (MINE, OTHER))
    lines = [json.loads(signed_envelope(b"payload", key)) for key in (first, second)]
    lines[0]["signatures"] += lines[1]["signatures"]
    both = read_envelope(json.dumps(lines[0]))
    assert both.is_signed_by(first.public)
    assert both.is_signed_by(second.public)
    lines[0]["signatures"][0]["sig"] = lines[1]["signatures"][0]["sig"]
    one = read_envelope(json.dumps(lines[0]))
    assert (one.is_signed_by(first.public), one.is_signed_by(second.public)) == (False, True)


def test_the_name_of_a_key_makes_no_signature_of_it() -> None:
    """The signature is of another key, under the name of mine."""
    content = json.loads(signed_envelope(b"payload", private_key(keys.private(OTHER), nobody)))
    content["signatures"][0]["keyid"] = json.loads(ENVELOPE)["signatures"][0]["keyid"]
    assert not verifies(json.dumps(content))


@pytest.mark.slow
def test_the_library_itself_reads_and_verifies_the_envelope() -> None:
    from securesystemslib.dsse import Envelope  # which imports botocore
    from securesystemslib.signer import SSlibKey

    envelope = Envelope.from_dict(json.loads(ENVELOPE))
    mine = public_key(keys.public(MINE))
    key = SSlibKey.from_crypto(MINE.public_key(), mine.fingerprint)
    assert envelope.verify([key], 1) == {mine.fingerprint: key}
    assert envelope.payload_type == PAYLOAD_TYPE == "application/vnd.in-toto+json"


@pytest.mark.slow
@pytest.mark.parametrize("kind", some(KINDS, 4))
def test_an_encrypted_key_needs_its_passphrase(kind: str) -> None:
    for form in (PrivateFormat.OpenSSH, PrivateFormat.PKCS8):
        data = keys.private(PAIRS[kind], "open sesame", form)
        public = private_key(data, lambda: "open sesame").public
        assert public == public_key(keys.public(PAIRS[kind]))
        for passphrase in some(("", "open", "öpen"), 2 if kind == KINDS[0] else 3):
            with pytest.raises(UnusableKeyError, match="the passphrase is wrong"):
                private_key(data, lambda passphrase=passphrase: passphrase)  # type: ignore[misc]


def test_pem_is_read_as_openssh_is() -> None:
    data = keys.private(MINE, form=PrivateFormat.PKCS8)
    text = MINE.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()
    assert private_key(data, nobody).public == public_key(text) == public_key(keys.public(MINE))


def test_keys_that_do_not_count_are_refused_with_a_reason() -> None:
    small = keys.public(keys.make("rsa1024"))
    old = dsa.generate_private_key(1024).public_key()
    text = old.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()
    for key, why in (
        (small, "an RSA key has 2048 bits or more, up to 16384"),
        (text, "only Ed25519, ECDSA and RSA keys are supported"),
        ("sk-ssh-ed25519@openssh.com AAAA", "it is not a public key of type `ssh-ed25519`"),
        ("ssh-ed25519-cert-v01@openssh.com AAAA", "it is not a public key of type"),
        ("ssh-ed25519 AAAA", "."),
        ("ssh-ed25519", "."),
        ("", "it is not a public key of type"),
    ):
        with pytest.raises(UnusableKeyError, match=why):
            public_key(key)
    for data in (b"", b"\0\xff", keys.public(MINE).encode(), b"-----BEGIN PRIVATE KEY-----\nx"):
        with pytest.raises(UnusableKeyError):
            private_key(data, nobody)


@pytest.mark.slow
@needs("ssh-keygen")
@pytest.mark.parametrize(
    "kind", some(["ed25519", "ecdsa -b 256", "ecdsa -b 521", "rsa -b 2048"], 2)
)
def test_ssh_keygen_makes_the_keys_and_names_them_alike(kind: str, tmp_path: Path) -> None:
    file = tmp_path / "key"
    for word in ("", "secret words"):
        file.unlink(missing_ok=True)
        new = [
            installed("ssh-keygen"),
            "-q",
            "-t",
            *kind.split(),
            "-N",
            word,
            "-C",
            "me",
            "-f",
            str(file),
        ]
        subprocess.run(new, check=True)
        file.chmod(0o644)  # ssh itself would refuse it
        line = subprocess.run(
            [installed("ssh-keygen"), "-l", "-f", f"{file}.pub"],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        mine = private_key(file.read_bytes(), lambda word=word: word)  # type: ignore[misc]
        assert mine.public.text == line.replace(" me ", " ").strip()
        assert mine.public == public_key(Path(f"{file}.pub").read_text())
        assert read_envelope(signed_envelope(b"x", mine)).is_signed_by(mine.public)
