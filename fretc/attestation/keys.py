"""SSH keys, and the DSSE envelopes that they sign and verify.

This is the only module that imports securesystemslib and cryptography, which an extra installs.

Sources: DSSE 1.0, https://github.com/secure-systems-lab/dsse; public keys of SSH: RFC 4253,
section 6.6, and RFC 8709.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
from collections.abc import Callable
from dataclasses import field

from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePublicKey
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPublicKey
from cryptography.hazmat.primitives.asymmetric.types import PrivateKeyTypes, PublicKeyTypes
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    PublicFormat,
    load_pem_private_key,
    load_pem_public_key,
    load_ssh_private_key,
    load_ssh_public_key,
)
from securesystemslib.dsse import Envelope
from securesystemslib.exceptions import UnverifiedSignatureError
from securesystemslib.signer import CryptoSigner, SSlibKey

from compiler.files.checked_json import JsonValue, plain
from fretish.classes.frozen import dataclass

PAYLOAD_TYPE = "application/vnd.in-toto+json"
"""DSSE's `payloadType` of an in-toto statement; no other payload is signed or read."""
KEY_TYPES = (
    "ssh-ed25519",
    "ecdsa-sha2-nistp256",
    "ecdsa-sha2-nistp384",
    "ecdsa-sha2-nistp521",
    "ssh-rsa",
)
"""The accepted types, as the first word of an OpenSSH public key names them.

Keys in a security token (`sk-...`) are not supported, because they do not sign the bytes alone.
"""
_RSA_MIN_BITS, _RSA_MAX_BITS = 2048, 16384
"""NIST SP 800-131A forbids shorter keys; OpenSSH does not generate longer ones."""


class UnusableKeyError(ValueError):
    """A key cannot be used; the text is the reason."""


@dataclass(frozen=True, slots=True)
class PublicKey:
    """A key that verifies signatures."""

    fingerprint: str
    """`SHA256:...`, as `ssh-keygen -l` prints it; the id of the key in envelopes."""
    bits: int
    kind: str
    """`ED25519`, `ECDSA` or `RSA`, as `ssh-keygen -l` prints it; not one of `KEY_TYPES`."""
    verifier: SSlibKey = field(compare=False, repr=False)

    @property
    def text(self) -> str:
        """`256 SHA256:... (ED25519)`: what `ssh-keygen -l` prints, without the comment."""
        return f"{self.bits} {self.fingerprint} ({self.kind})"


@dataclass(frozen=True, slots=True)
class PrivateKey:
    """A key that signs, with its public half."""

    public: PublicKey
    signer: CryptoSigner = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class DsseEnvelope:
    """A payload with unverified signatures."""

    payload: bytes
    key_ids: tuple[str, ...]
    """Fingerprint of the key that each signature names, which is not verified."""
    library_envelope: Envelope = field(compare=False, repr=False)
    """The envelope as securesystemslib represents it."""

    def is_signed_by(self, key: PublicKey) -> bool:
        """Whether the key verifies one of the signatures of the payload."""
        try:
            self.library_envelope.verify([key.verifier], 1)
        except UnverifiedSignatureError:
            return False
        return True


# Keys ------------------------------------------------------------------------------------------


def public_key(text: str) -> PublicKey:
    """The public key in a text in OpenSSH or PEM format.

    Raises:
        UnusableKeyError: the text is not a public key of a supported type.
    """
    words = text.split()
    is_pem = text.lstrip().startswith("-----BEGIN ")
    if not is_pem and (not words or words[0] not in KEY_TYPES):
        raise UnusableKeyError(
            f"it is not a public key of type {', '.join(f'`{t}`' for t in KEY_TYPES)}"
        )
    try:
        load = load_pem_public_key if is_pem else load_ssh_public_key
        return _public_key(load(text.strip().encode()))
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise UnusableKeyError(_why(error)) from None


def private_key(data: bytes, passphrase: Callable[[], str]) -> PrivateKey:
    """The private key in a file in OpenSSH or PEM format.

    Args:
        data: the content of the file.
        passphrase: asks the user for the passphrase; called only if the key has one.

    Raises:
        UnusableKeyError: the file is not a private key of a supported type, or the passphrase is
        wrong.
    """
    if not data.lstrip().startswith(b"-----BEGIN ") or b"PRIVATE KEY-----" not in data:
        raise UnusableKeyError("it is not a private key")
    try:
        key = _library_key(data, passphrase)
        public = _public_key(key.public_key())
        return PrivateKey(public, CryptoSigner(key, public.verifier))
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise UnusableKeyError(_why(error)) from None


def _library_key(data: bytes, passphrase: Callable[[], str]) -> PrivateKeyTypes:
    """The decrypted private key, as an object of the library cryptography."""
    load = load_ssh_private_key if b"OPENSSH" in data.split(b"\n", 1)[0] else load_pem_private_key
    try:
        return load(data, None)
    except TypeError:  # Both functions raise it for an encrypted key without a passphrase.
        secret = passphrase().encode()
    try:
        return load(data, secret)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        # Other errors have no further information.
        why = f": {_why(error)}" if isinstance(error, UnsupportedAlgorithm) else ""
        raise UnusableKeyError(f"the passphrase is wrong, or the file is damaged{why}") from None


def _public_key(key: PublicKeyTypes) -> PublicKey:
    """The key with its fingerprint, which is the SHA-256 of its binary form (RFC 4253)."""
    bits, kind = _bits_and_kind(key)
    blob = key.public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH).split()[1]
    digest = hashlib.sha256(base64.b64decode(blob)).digest()
    fingerprint = f"SHA256:{base64.b64encode(digest).decode().rstrip('=')}"
    return PublicKey(fingerprint, bits, kind, SSlibKey.from_crypto(key, fingerprint))


def _bits_and_kind(key: PublicKeyTypes) -> tuple[int, str]:
    """Length and type of a key, as `ssh-keygen -l` prints them.

    Raises:
        UnusableKeyError: the key is too short, too long, or of another kind.
    """
    match key:
        case Ed25519PublicKey():
            return 256, "ED25519"
        case EllipticCurvePublicKey():
            return key.key_size, "ECDSA"
        case RSAPublicKey() if _RSA_MIN_BITS <= key.key_size <= _RSA_MAX_BITS:
            return key.key_size, "RSA"
        case RSAPublicKey():
            raise UnusableKeyError(
                f"an RSA key has {_RSA_MIN_BITS} bits or more, up to {_RSA_MAX_BITS}"
            )
        case _:
            raise UnusableKeyError("only Ed25519, ECDSA and RSA keys are supported")


def _why(error: Exception) -> str:
    """The message of an error, for the end of a sentence."""
    if isinstance(error, UnusableKeyError):  # This ValueError has a message of fretc.
        return str(error)
    message = str(error).strip().rstrip(".") or type(error).__name__
    return f"{message[:1].lower()}{message[1:]}"


# Envelopes -------------------------------------------------------------------------------------


def signed_envelope(payload: bytes, key: PrivateKey) -> str:
    """An envelope with the payload and one signature, as one line of JSON."""
    envelope = Envelope(payload, PAYLOAD_TYPE, {})
    envelope.sign(key.signer)
    return json.dumps(envelope.to_dict(), sort_keys=True)


def read_envelope(line: str) -> DsseEnvelope:
    """The envelope in a line of JSON. Its structure is checked, its signatures are not.

    The checks are stricter than DSSE: the payload type is `PAYLOAD_TYPE`, each signature names its
    key, no two signatures name the same key, and there are no other fields.

    Raises:
        SchemaError: the JSON has another structure.
    """
    shape = JsonValue(plain(line))
    shape.only("payload", "payloadType", "signatures")
    shape.field("payloadType").one_of((PAYLOAD_TYPE,))
    signatures = shape.field("signatures").items()
    if not signatures:
        raise shape.field("signatures").wrong("a list of signatures")
    for signature in signatures:
        signature.only("keyid", "sig")
        signature.field("keyid").text()
        _bytes(signature.field("sig"))
    key_ids = tuple(signature.field("keyid").text() for signature in signatures)
    if len(set(key_ids)) < len(key_ids):
        raise shape.field("signatures").wrong("one signature for each key")
    payload = _bytes(shape.field("payload"))
    return DsseEnvelope(payload, key_ids, Envelope.from_dict(json.loads(line)))


def _bytes(value: JsonValue) -> bytes:
    """Decode a base64 string.

    Only the canonical encoding is accepted, so that a payload or signature has exactly one valid
    text.
    """
    text = value.text()
    try:
        data = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise value.wrong("base64") from None
    if base64.b64encode(data).decode() != text:
        raise value.wrong("base64")
    return data
