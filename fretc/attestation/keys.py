"""Keys and envelopes: who signs bytes, and whether somebody has signed them.

The only module that imports securesystemslib and cryptography, which an extra installs.

Sources: DSSE 1.0, https://github.com/secure-systems-lab/dsse; for public keys of SSH RFC 4253,
section 6.6, and RFC 8709.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field

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

from compiler.files.checked_json import Shape, plain

PAYLOAD_TYPE = "application/vnd.in-toto+json"
KEY_TYPES = (
    "ssh-ed25519",
    "ecdsa-sha2-nistp256",
    "ecdsa-sha2-nistp384",
    "ecdsa-sha2-nistp521",
    "ssh-rsa",
)
"""As OpenSSH calls them. A key in a token (`sk-...`) signs no plain bytes."""
_SHORTEST, _LONGEST = 2048, 16384
"""Bits of an RSA key that counts; OpenSSH knows no longer one."""


class UnusableKeyError(ValueError):
    """A key cannot be used; the text says why."""


@dataclass(frozen=True, slots=True)
class PublicKey:
    """A key that verifies."""

    fingerprint: str
    """`SHA256:...`, as `ssh-keygen -l` prints it; envelopes name the key by it."""
    bits: int
    kind: str
    verifier: SSlibKey = field(compare=False, repr=False)

    @property
    def text(self) -> str:
        """`256 SHA256:... (ED25519)`: what `ssh-keygen -l` prints, without the comment."""
        return f"{self.bits} {self.fingerprint} ({self.kind})"


@dataclass(frozen=True, slots=True)
class PrivateKey:
    """A key that signs."""

    public: PublicKey
    signer: CryptoSigner = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Sealed:
    """A payload with its signatures, which nobody has looked at yet."""

    payload: bytes
    keys: tuple[str, ...]
    """Fingerprints of the keys that the signatures name."""
    envelope: Envelope = field(compare=False, repr=False)

    def is_signed_by(self, key: PublicKey) -> bool:
        """Whether a signature of exactly this payload is by the key."""
        try:
            self.envelope.verify([key.verifier], 1)
        except UnverifiedSignatureError:
            return False
        return True


# Keys ------------------------------------------------------------------------------------------


def public_key(text: str) -> PublicKey:
    """A public key as OpenSSH or as PEM.

    Raises:
        UnusableKeyError: it is none, or of a kind that is not taken.
    """
    words = text.split()
    is_pem = text.lstrip().startswith("-----BEGIN ")
    if not is_pem and (not words or words[0] not in KEY_TYPES):
        raise UnusableKeyError(f"it is no public key of {', '.join(f'`{t}`' for t in KEY_TYPES)}")
    try:
        load = load_pem_public_key if is_pem else load_ssh_public_key
        return _public(load(text.strip().encode()))
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise UnusableKeyError(_why(error)) from None


def private_key(data: bytes, passphrase: Callable[[], str]) -> PrivateKey:
    """A private key as OpenSSH or as PEM.

    Args:
        data: the content of its file.
        passphrase: asks for it; called only where the key has one.

    Raises:
        UnusableKeyError: it is none, or of a kind that is not taken, or the passphrase is wrong.
    """
    if not data.lstrip().startswith(b"-----BEGIN ") or b"PRIVATE KEY-----" not in data:
        raise UnusableKeyError("it is no private key")
    try:
        key = _loaded(data, passphrase)
        public = _public(key.public_key())
        return PrivateKey(public, CryptoSigner(key, public.verifier))
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise UnusableKeyError(_why(error)) from None


def _loaded(data: bytes, passphrase: Callable[[], str]) -> PrivateKeyTypes:
    load = load_ssh_private_key if b"OPENSSH" in data.split(b"\n", 1)[0] else load_pem_private_key
    try:
        return load(data, None)
    except TypeError:  # so both say that it is encrypted
        word = passphrase().encode()
    try:
        return load(data, word)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        why = f": {_why(error)}" if isinstance(error, UnsupportedAlgorithm) else ""
        raise UnusableKeyError(f"its passphrase is another one, or it is damaged{why}") from None


def _public(key: PublicKeyTypes) -> PublicKey:
    bits, kind = _size(key)
    blob = key.public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH).split()[1]
    digest = hashlib.sha256(base64.b64decode(blob)).digest()
    fingerprint = f"SHA256:{base64.b64encode(digest).decode().rstrip('=')}"
    return PublicKey(fingerprint, bits, kind, SSlibKey.from_crypto(key, fingerprint))


def _size(key: PublicKeyTypes) -> tuple[int, str]:
    """Its length in bits, and its kind as `ssh-keygen -l` says it."""
    match key:
        case Ed25519PublicKey():
            return 256, "ED25519"
        case EllipticCurvePublicKey():
            return key.key_size, "ECDSA"
        case RSAPublicKey() if _SHORTEST <= key.key_size <= _LONGEST:
            return key.key_size, "RSA"
        case RSAPublicKey():
            raise UnusableKeyError(f"an RSA key has {_SHORTEST} bits at least, {_LONGEST} at most")
        case _:
            raise UnusableKeyError("only Ed25519, ECDSA and RSA keys are taken")


def _why(error: Exception) -> str:
    """What a library says, as the end of a sentence."""
    if isinstance(error, UnusableKeyError):
        return str(error)
    message = str(error).strip().rstrip(".") or type(error).__name__
    return f"{message[:1].lower()}{message[1:]}"


# Envelopes -------------------------------------------------------------------------------------


def sealed(payload: bytes, key: PrivateKey) -> str:
    """The payload in an envelope with one signature, on one line of JSON."""
    envelope = Envelope(payload, PAYLOAD_TYPE, {})
    envelope.sign(key.signer)
    return json.dumps(envelope.to_dict(), sort_keys=True)


def opened(line: str) -> Sealed:
    """An envelope from its JSON, in exactly the form that it must have.

    Raises:
        MisshapenError: it is none.
    """
    shape = Shape(plain(line))
    shape.only("payload", "payloadType", "signatures")
    shape.field("payloadType").one_of((PAYLOAD_TYPE,))
    signatures = shape.field("signatures").items()
    if not signatures:
        raise shape.field("signatures").wrong("a list of signatures")
    for signature in signatures:
        signature.only("keyid", "sig")
        signature.field("keyid").text()
        _bytes(signature.field("sig"))
    keys = tuple(signature.field("keyid").text() for signature in signatures)
    if len(set(keys)) < len(keys):
        raise shape.field("signatures").wrong("one signature for each key")
    payload = _bytes(shape.field("payload"))
    return Sealed(payload, keys, Envelope.from_dict(json.loads(line)))


def _bytes(at: Shape) -> bytes:
    """What base64 stands for; each content has one text."""
    text = at.text()
    try:
        data = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise at.wrong("base64") from None
    if base64.b64encode(data).decode() != text:
        raise at.wrong("base64")
    return data
