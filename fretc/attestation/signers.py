"""`allowed_signers`: the list of trusted keys, in the format of `ssh-keygen -Y verify` and git.

Source: ssh-keygen(1), ALLOWED SIGNERS.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fnmatch import fnmatchcase

from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from fretc.attestation.keys import KEY_TYPES, PublicKey, UnusableKeyError, public_key
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget

NAMESPACE = "fretc"
"""A line with `namespaces="..."` is used only if it includes this namespace."""
_LINE = re.compile(
    r"""(?:"(?P<quoted>[^"\n]+)"|(?P<plain>[^\s"]+))[ \t]+
        (?:(?P<options>(?:[^\s"]|"[^"\n]*")+)[ \t]+)?
        (?P<type>(?:ssh|ecdsa|sk)-[\w.@-]+)[ \t]+(?P<key>[A-Za-z0-9+/=]+)(?:[ \t].*)?""",
    re.VERBOSE,
)
_OPTION = re.compile(r'(?P<name>[\w-]+)(?:="(?P<value>[^"]*)")?(?:,|$)')


@dataclass(frozen=True, slots=True)
class Signer:
    """A key, and the names of its holders."""

    principals: tuple[str, ...]
    """Names of the holders; `*` and `?` are wildcards, and `!` excludes a name."""
    key: PublicKey

    @property
    def name(self) -> str:
        """Name and key for a reader."""
        named = ", ".join(self.principals)
        return f"{named} ({self.key.fingerprint})" if named else self.key.fingerprint

    def goes_by(self, name: str) -> bool:
        """Whether the key belongs to a person of that name."""
        denied = any(_fits(name, p[1:]) for p in self.principals if p.startswith("!"))
        return not denied and any(_fits(name, p) for p in self.principals)


def _fits(name: str, pattern: str) -> bool:
    return fnmatchcase(name, pattern.replace("[", "[[]"))


@dataclass(frozen=True, slots=True)
class Signers:
    """The content of a list of signers."""

    file: str
    sha256: str
    signers: tuple[Signer, ...]
    remarks: tuple[Diagnostic, ...] = ()
    """Diagnostics about ignored lines."""


def read(path: str) -> Signers | Diagnostic:
    """The signers in a file, or F548."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    return with_budget(len(source.text), source.span(), lambda: _read(source))


def trusted(path: str) -> Signers | Diagnostic:
    """The signers in a file: a single public key (OpenSSH or PEM), or a list of signers."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    words = source.text.split(None, 1)
    if not words or (words[0] not in KEY_TYPES and not source.text.startswith("-----BEGIN ")):
        return read(path)
    try:
        key = public_key(source.text)
    except UnusableKeyError as error:
        return bad_key(path, error)
    return Signers(path, sha256(source.text), (Signer((), key),))


def bad_key(path: str, error: UnusableKeyError) -> Diagnostic:
    """F931: the key in the file cannot be used."""
    return diagnostic("unusable_key", Source(path, "").span(), path=path, error=error)


def _read(source: Source) -> Signers | Diagnostic:
    signers: list[Signer] = []
    remarks: list[Diagnostic] = []
    for line in _lines(source):
        one = _signer(line)
        if isinstance(one, Diagnostic) and one.is_error:
            return one
        if isinstance(one, Diagnostic):
            remarks.append(one)
        elif one is not None:
            signers.append(one)
    return Signers(source.name, sha256(source.text), tuple(signers), tuple(remarks))


def _lines(source: Source) -> Iterator[Span]:
    """The lines of a file that are neither empty nor comments."""
    start = 0
    for text in source.text.split("\n"):
        line = text.rstrip()
        if line.strip() and not line.lstrip().startswith("#"):
            yield source.span(start + len(line) - len(line.lstrip()), start + len(line))
        start += len(text) + 1


def _signer(line: Span) -> Signer | Diagnostic | None:
    """The signer in a line; None if the key is for another purpose."""
    match = _LINE.fullmatch(line.text)
    if match is None:
        return _wrong(line, "the line is not `NAME KEY-TYPE KEY`")
    options = list(_OPTION.finditer(match["options"] or ""))
    if "".join(option[0] for option in options) != (match["options"] or ""):
        return _wrong(line, f"`{match['options']}` are not valid options")
    for option in options:
        if option["name"].lower() != "namespaces":
            return _unused(line, f"fretc does not know `{option['name']}`")
        if not _is_for_us(option["value"] or ""):
            return None
    if match["type"] not in KEY_TYPES:
        return _unused(line, f"fretc does not support keys of type `{match['type']}`")
    try:
        key = public_key(f"{match['type']} {match['key']}")
    except UnusableKeyError as error:
        return _wrong(line, f"the key cannot be used: {error}")
    return Signer(tuple((match["quoted"] or match["plain"]).split(",")), key)


def _is_for_us(namespaces: str) -> bool:
    return any(_fits(NAMESPACE, pattern) for pattern in namespaces.split(","))


def _wrong(line: Span, what: str) -> Diagnostic:
    fix = "write `name@example.org ssh-ed25519 AAAA...`, see ALLOWED SIGNERS in ssh-keygen(1)"
    return Diagnostic(Code.BAD_SIGNERS, what, line, help=fix)


def _unused(line: Span, why: str) -> Diagnostic:
    return diagnostic(
        "ignored_key",
        line,
        why=why,
        types=", ".join(f"`{each}`" for each in KEY_TYPES),
        namespace=NAMESPACE,
    )
