"""Keys to sign with, as OpenSSH writes them."""

from pathlib import Path

from cryptography.hazmat.primitives.asymmetric import ec, ed25519, rsa
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    KeySerializationEncryption,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
)

Key = ed25519.Ed25519PrivateKey | ec.EllipticCurvePrivateKey | rsa.RSAPrivateKey


def make(kind: str) -> Key:
    """A new key of a kind: `ed25519`, `nistp256`, `rsa2048`."""
    if kind == "ed25519":
        return ed25519.Ed25519PrivateKey.generate()
    if kind.startswith("rsa"):
        return rsa.generate_private_key(65537, int(kind.removeprefix("rsa")))
    curves = {"nistp256": ec.SECP256R1(), "nistp384": ec.SECP384R1(), "nistp521": ec.SECP521R1()}
    return ec.generate_private_key(curves[kind])


def private(key: Key, passphrase: str = "", form: PrivateFormat = PrivateFormat.OpenSSH) -> bytes:
    hidden: KeySerializationEncryption = NoEncryption()
    if passphrase:
        hidden = BestAvailableEncryption(passphrase.encode())
    return key.private_bytes(Encoding.PEM, form, hidden)


def public(key: Key) -> str:
    """`ssh-ed25519 AAAA...`."""
    return key.public_key().public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH).decode()


def written(name: str, kind: str = "ed25519", passphrase: str = "") -> str:
    """A new key in files `NAME` and `NAME.pub` of the current folder; the name."""
    key = make(kind)
    Path(name).write_bytes(private(key, passphrase))
    Path(f"{name}.pub").write_text(f"{public(key)} a comment\n", encoding="utf-8")
    return name


def line(principals: str, name: str, options: str = "") -> str:
    """A line of `allowed_signers` for a key of the current folder."""
    text = Path(f"{name}.pub").read_text(encoding="utf-8")
    return " ".join(filter(None, [f'"{principals}"', options, text]))
