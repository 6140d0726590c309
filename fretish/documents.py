"""`.fret` files: TOML headers between `+++` lines, each followed by one bare sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import PurePath
from typing import Any

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.toml_text import Tables, read, unknown_key

FIELDS = (
    "id", "kind", "title", "text", "parents", "rationale", "status", "verify", "params", "accept",
    "fret",
)  # fmt: skip
STATUSES = ("draft", "approved", "retired")
ASSUMPTION = "assumption"
KINDS = ("requirement", ASSUMPTION)
"""A requirement demands something of the system, an assumption of its environment."""
IDENTIFIER = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
"""The id of a requirement."""
_ID_LINE = re.compile(rf'^[ \t]*id[ \t]*=[ \t]*"(?P<id>{IDENTIFIER.pattern})"', re.MULTILINE)
_FREE_TEXT = re.compile(r'"[^"]*"')
_WHITE_SPACE = " \t\r\n\f\v\u00a0"
"""White space around and between the words of a sentence, as in `grammar.lark`."""
_FENCE = re.compile(r"^\ufeff?\+\+\+[ \t]*(?:\r?\n|\Z)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class RequirementEntry:
    """A requirement of a file: its header fields, and its unparsed sentence."""

    id: str
    wording: Span
    """The FRETish sentence, without surrounding white space."""
    title: str = ""
    text: str = ""
    """The requirement in natural language."""
    parents: tuple[str, ...] = ()
    """Ids of hazards and of parent requirements."""
    rationale: str = ""
    status: str = "draft"
    kind: str = KINDS[0]
    verify: tuple[str, ...] = ()
    """The planned verification methods."""
    params: Mapping[str, str] = field(default_factory=dict)
    """Proposition → the number that the requirement states for it."""
    accept: Mapping[str, str] = field(default_factory=dict)
    """Code of an accepted warning → the reason."""
    fret: Mapping[str, str] = field(default_factory=dict)
    """FRET's other fields, which fretc does not use: project, comments, ..."""
    header: Tables | None = field(default=None, compare=False, repr=False)
    mistakes: tuple[Diagnostic, ...] = ()
    """The errors of the header; if there are any, its fields are not read."""

    def __hash__(self) -> int:
        """By identity: two requirements may have one id, and none has two meanings."""
        return id(self)

    @property
    def name(self) -> str:
        """The display name: `No contact (R14)`, or the id if there is no title."""
        return named(self.id, self.title)

    @property
    def is_in_force(self) -> bool:
        """Whether the requirement is not retired."""
        return self.status != "retired"

    @property
    def is_assumption(self) -> bool:
        """Whether it demands something of the environment."""
        return self.kind == ASSUMPTION

    @property
    def is_free_text(self) -> bool:
        """Whether the whole text is in double quotes: it is kept, and not formalized."""
        return _FREE_TEXT.fullmatch(self.wording.text) is not None

    def contains(self, span: Span | None) -> bool:
        """Whether a span is in the header or the sentence."""
        if span is None or span.source.name != self.wording.source.name:
            return False
        start = self.header.text.start if self.header else self.wording.start
        return start <= span.start <= self.wording.end

    def place(self, *path: str) -> Span:
        """The span of a header field; the sentence if there is no header."""
        return self.header.value(*path) if self.header else self.wording


def named(id: str, title: str) -> str:
    """The display name of a requirement: `TITLE (ID)`, or the id if there is no title."""
    return f"{title} ({id})" if title else id


def requirements(source: Source) -> tuple[tuple[RequirementEntry, ...], tuple[Diagnostic, ...]]:
    """Parse the requirements of a `.fret` text; the diagnostics are those of their headers.

    A requirement whose header has errors is in the result, too, so that it is reported. If its id
    cannot be read, the file name is its id.
    """
    entries: list[RequirementEntry] = []
    diagnostics: list[Diagnostic] = []
    pairs = _pairs(source)
    if isinstance(pairs, Diagnostic):
        return (_unread(source, source.span(), pairs),), (pairs,)
    for header, wording in pairs:
        requirement, mistakes = _requirement(source, header, wording, alone=len(pairs) == 1)
        diagnostics.extend(mistakes)
        entries.append(requirement)
    return tuple(entries), tuple(diagnostics)


def unreadable_file(path: str, why: Diagnostic) -> RequirementEntry:
    """A requirement that represents an unreadable file, with the file name as its id."""
    source = Source(path, "")
    return _unread(source, source.span(), why)


def _pairs(source: Source) -> list[tuple[Span | None, Span]] | Diagnostic:
    """The pairs of header (or None) and sentence, in the order of the file."""
    fences = list(_FENCE.finditer(source.text))
    if len(fences) % 2:
        return _unclosed(source, fences[-1])
    ends = [*(match.start() for match in fences), len(source.text)]
    pairs: list[tuple[Span | None, Span]] = []
    first = _stripped(source.span(0, ends[0]))
    if first.text or not fences:
        pairs.append((None, first))
    for i in range(0, len(fences), 2):
        header = source.span(fences[i].end(), fences[i + 1].start())
        pairs.append((header, _stripped(source.span(fences[i + 1].end(), ends[i + 2]))))
    return pairs


def part_at(text: str, offset: int) -> tuple[int, bool]:
    """Where the header or the sentence around an offset begins, and whether it is a header.

    Args:
        text: the text of a `.fret` file, which may have mistakes.
        offset: an offset of the text.
    """
    ends = [match.end() for match in _FENCE.finditer(text) if match.end() <= offset]
    return (ends[-1] if ends else 0), len(ends) % 2 == 1


def _stripped(span: Span) -> Span:
    text = span.text
    start = len(text) - len(text.lstrip(f"\ufeff{_WHITE_SPACE}"))
    return span.part(start, max(start, len(text.rstrip(_WHITE_SPACE))))


def _requirement(
    source: Source, header: Span | None, wording: Span, *, alone: bool
) -> tuple[RequirementEntry, tuple[Diagnostic, ...]]:
    stem = _stem(source)
    if header is None:
        return RequirementEntry(stem, wording), ()
    tables = read(header, Code.BAD_HEADER, "the header")
    if isinstance(tables, Diagnostic):
        return _unread(source, wording, tables, header.text, alone=alone), (tables,)
    data = tables.data
    mistakes = tuple(_mistakes(tables, alone=alone))
    if mistakes:
        id = data.get("id")
        name = str(id) if _fits("id", id) else _called(source, wording, alone=alone)
        return RequirementEntry(name, wording, header=tables, mistakes=mistakes), mistakes
    return (
        RequirementEntry(
            id=data.get("id", stem),
            wording=wording,
            title=data.get("title", ""),
            text=data.get("text", ""),
            parents=tuple(data.get("parents", ())),
            rationale=data.get("rationale", ""),
            status=data.get("status", "draft"),
            kind=data.get("kind", KINDS[0]),
            verify=tuple(data.get("verify", ())),
            params=dict(data.get("params", {})),
            accept=dict(data.get("accept", {})),
            fret=dict(data.get("fret", {})),
            header=tables,
        ),
        (),
    )


def _stem(source: Source) -> str:
    """The name of the file without suffix; `_` replaces unprintable characters."""
    stem = PurePath(source.name).stem.strip("<>") or "requirement"
    return "".join(character if character.isprintable() else "_" for character in stem)


def _called(source: Source, wording: Span, *, alone: bool) -> str:
    """The id of a requirement without one: its file, and its line if the file has several."""
    return _stem(source) if alone else f"{_stem(source)}-line-{wording.line}"


def _unread(
    source: Source, wording: Span, why: Diagnostic, header: str = "", *, alone: bool = True
) -> RequirementEntry:
    """A requirement whose header is not TOML; its id is read from a line like `id = "R1"`."""
    match = _ID_LINE.search(header)
    id = match["id"] if match else _called(source, wording, alone=alone)
    return RequirementEntry(id, wording, mistakes=(why,))


def _mistakes(tables: Tables, *, alone: bool) -> Iterator[Diagnostic]:
    for key, value in tables.data.items():
        if key not in FIELDS:
            yield unknown_key(
                Code.UNKNOWN_FIELD, key, FIELDS, tables.place(key), "a requirement's header"
            )
        elif not _fits(key, value):
            yield _bad_field(tables, key)
    if "id" not in tables.data and not alone:
        yield diagnostic("id_missing", tables.text.part(0, 0))


def _fits(key: str, value: Any) -> bool:
    match key:
        case "parents" | "verify":
            return isinstance(value, list) and all(isinstance(item, str) for item in value)
        case "params" | "accept" | "fret":
            return isinstance(value, dict) and all(isinstance(v, str) for v in value.values())
        case "id":
            return isinstance(value, str) and IDENTIFIER.fullmatch(value) is not None
        case "status":
            return value in STATUSES
        case "kind":
            return value in KINDS
        case _:
            return isinstance(value, str)


def _bad_field(tables: Tables, key: str) -> Diagnostic:
    wanted = {
        "parents": 'a list of ids: `["HAZ-003"]`',
        "verify": 'a list of methods: `["audit", "ajpf"]`',
        "params": 'a table of quantities in quotes: `{ too_close = "5 cm" }`',
        "accept": 'a table of reasons: `{ F206 = "the mode ends only by hand" }`',
        "fret": 'a table of texts: `{ project = "Rover" }`',
        "id": "letters, digits, `_`, `-` and `.` in quotes, beginning with a letter or digit",
        "status": f"one of {', '.join(STATUSES)}",
        "kind": f"one of {', '.join(KINDS)}",
    }
    return diagnostic(
        "bad_field", tables.value(key), key=key, value=wanted.get(key, "a text in quotes")
    )


def _unclosed(source: Source, fence: re.Match[str]) -> Diagnostic:
    return diagnostic("unclosed_header", source.span(fence.start(), fence.start() + 3))
