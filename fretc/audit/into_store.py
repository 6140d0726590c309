"""An audit into a store: results are written as they are found, and unchanged logs are reused.

In memory are only the logs of the parts that are being filled. Whatever ends the audit early, what
is finished is in the store (`unfinished.json`), and the next audit takes it over.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from compiler.files.build_id import __version__
from compiler.files.records import UNSET, replace
from compiler.files.text_files import destination, write
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.many_logs import (
    Engine,
    LogResult,
    diagnostics_of_all,
    document,
    estimates_of,
    with_command_labels,
)
from fretc.audit.plan import Plan, keys
from fretc.audit.store.errors import StoreError
from fretc.audit.store.manifest import FILE, REUSE, SCHEMA, UNFINISHED, Part, StoreManifest
from fretc.audit.store.parts import parts
from fretc.audit.store.reader import Store, manifest, opened
from fretc.audit.store.recordings import KnownBy
from fretc.audit.store.register import (
    Entry,
    diagnostic,
    diagnostic_text,
    marks,
    vouched,
    vouches,
)
from fretc.audit.store.tables import Tables, joined, to_tables
from fretc.audit.store.writer import (
    files,
    is_store,
    remove,
    remove_others,
    write_manifest,
    write_part,
    write_register,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.system.files import FolderLock

_HEAVY = 2_000
"""Events of a log from which on its results become columns at once, without waiting for the other
logs of its part."""
_PATIENCE = 2.0
"""Seconds after which finished results are written."""
_SHARE = 20
"""The inverse of the largest share of the time that writing unfinished results may take."""


@dataclass(frozen=True, slots=True)
class StoredAudit:
    """The outcome of an audit with its results in a store."""

    source: Store
    diagnostics: tuple[Diagnostic, ...]
    read: int
    """Number of logs that could be read."""
    estimates: tuple[Estimated, ...]


# Reusable results --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _ReusableLog:
    """A log of an earlier audit with the same plan."""

    store: Store
    entry: Entry
    by: KnownBy
    part: int
    index: int
    """The index of its first result."""
    results: int


@dataclass(frozen=True, slots=True)
class _PartlyReusableLog:
    """A log of an audit with a plan that has some of the same requirements."""

    store: Store
    claims: Collection[str]
    part: range
    """The indices of all results of its part."""
    first: int
    """The position of its first result in the part."""
    count: int


class ReusableResults:
    """Reusable results of earlier audits: those that this user's key authenticates."""

    def __init__(self, folder: Path, plan: Plan, key: bytes | None, *, rehash: bool) -> None:
        """Read the existing manifests and registers.

        Args:
            folder: of the store.
            plan: the plan of the present audit.
            key: the key of the user; None: no earlier result is reused.
            rehash: identify logs by their SHA-256 alone, not by size and times.
        """
        self.stale = False
        """Whether a store with another plan exists."""
        self.foreign = False
        """Whether a store exists that this user's key does not authenticate."""
        self._plan, self._rehash = plan, rehash
        self._logs: dict[str, tuple[Store, Entry, int, int, int]] = {}
        self._parts: dict[tuple[str, ...], tuple[Store, Part]] = {}
        self.claims: set[str] = set()
        """The keys of requirements of another plan that are also in this one."""
        self._some: dict[str, _PartlyReusableLog] = {}
        self._last: tuple[Store, range, list[Result]] | None = None
        """The results of the last part that was read, because logs of one part are asked for in
        sequence."""
        for name in (FILE, UNFINISHED) if key is not None else ():
            assert key is not None
            self._read(folder, name, key)

    def _read(self, folder: Path, name: str, key: bytes) -> None:
        store = opened(str(folder), name) if (folder / name).is_file() else None
        if not isinstance(store, Store):
            return
        about = vouches(folder, REUSE[name], store.sha256, key)
        if about is None:
            self.foreign = True
            return
        if about["plan"] != self._plan.key:
            self.stale = True
            claims = keys(self._plan)
            same = {id for id, key in about["claims"].items() if claims.get(id) == key}
            with suppress(StoreError):
                self._add_some(store, same)
            return
        with suppress(StoreError):
            self._add(store, alike=about["labels"] == dict(self._plan.labels))

    def _add_some(self, store: Store, same: Collection[str]) -> None:
        """Add results of unchanged requirements from an audit with another plan."""
        entries, counts = store.register(), [*store.counts()]
        if not same or len(entries) != len(counts):
            return
        self.claims |= {*same}
        row = index = 0
        for part in store.manifest.parts:
            stop, at = index + part.results, index
            for entry, count in zip(
                entries[row : row + part.runs], counts[row : row + part.runs], strict=True
            ):
                self._some[entry.log] = _PartlyReusableLog(
                    store, same, range(index, stop), at - index, count
                )
                at += count
            row, index = row + part.runs, stop

    def _add(self, store: Store, *, alike: bool) -> None:
        entries, counts = store.register(), [*store.counts()]
        if len(entries) != len(counts):
            return
        row = index = 0
        for number, part in enumerate(store.manifest.parts):
            of_part = entries[row : row + part.runs]
            for entry, count in zip(of_part, counts[row : row + part.runs], strict=True):
                self._logs[entry.log] = (store, entry, number, index, count)
                index += count
            row += part.runs
            if alike:
                self._parts[tuple(entry.log for entry in of_part)] = (store, part)

    def missing(self, logs: Sequence[str]) -> int:
        """The number of known logs that are not among the given ones."""
        return len({*self._logs, *self._some}.difference(logs))

    def find(self, log: str) -> _ReusableLog | None:
        """The reusable results of a log that is unchanged."""
        if log not in self._logs:
            return None
        store, entry, part, index, count = self._logs[log]
        by = entry.known_by_now(rehash=self._rehash)
        return None if by is None else _ReusableLog(store, entry, by, part, index, count)

    def results(self, log: str) -> tuple[Result, ...]:
        """The reusable results of a log from an audit with another plan."""
        partial = self._some.get(log)
        if partial is None:
            return ()
        if (
            self._last is None
            or self._last[0] is not partial.store
            or self._last[1] != partial.part
        ):
            try:
                results_of_part = [each for _, each in partial.store.details(partial.part)]
            except StoreError:
                results_of_part = []
            self._last = partial.store, partial.part, results_of_part
        of_log = self._last[2][partial.first : partial.first + partial.count]
        return tuple(each for each in of_log if each.requirement in partial.claims)

    def part(self, logs: Sequence[str], known: Mapping[str, _ReusableLog]) -> Part | None:
        """A part that has exactly these logs, with the facts that all its runs share."""
        store, part = self._parts.get(tuple(logs), (None, None))
        is_same = all(log in known and known[log].store is store for log in logs)
        return part if is_same else None


def _results(plan: Plan, known: _ReusableLog) -> tuple[Result, ...]:
    """The results of a known log, with the labels of the present audit."""
    indices = range(known.index, known.index + known.results)
    own = known.entry.labels or UNSET
    results = (replace(one, labels=own) for _, one in known.store.details(indices))
    return with_command_labels(plan, LogResult(tuple(results), (), read=True)).results


# The writer ------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Log:
    """A finished log, until its part is written."""

    entry: Entry
    results: tuple[Result, ...] = ()
    tables: Tables | None = None
    known: _ReusableLog | None = None


@dataclass(slots=True)
class _PartDraft:
    """A part that is being filled or written."""

    logs: Sequence[str]
    found: dict[str, _Log] = field(default_factory=dict)
    entries: tuple[Entry, ...] = ()
    part: Part | None = None


class _WriteError(Exception):
    """A file of the store cannot be written."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


class StoreWriter:
    """The writer of an audit's results into a store, from the beginning to the end of the audit."""

    def __init__(
        self, folder: Path, plan: Plan, logs: Sequence[str], key: bytes | None, *, rehash: bool
    ) -> None:
        """Lock the folder and find the logs with reusable results.

        Args:
            folder: of the store.
            plan: the plan of the audit.
            logs: each once.
            key: the key of the user; None: no result is reused, now or later.
            rehash: identify logs by their SHA-256 alone, not by size and times.

        Raises:
            OSError: the folder cannot be used.
        """
        self.folder, self._plan, self._key = folder, plan, key
        destination(folder / FILE)
        self._new_folder = None if folder.parent.exists() else folder.parent
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = FolderLock(folder)
        try:
            self.earlier = ReusableResults(folder, plan, key, rehash=rehash)
        except BaseException:
            self._lock.release()
            raise
        self._before = files(folder)
        """Files that existed before: an earlier manifest that is damaged may need them."""
        self._is_finished = False
        self._drafts = [_PartDraft([logs[n] for n in indices]) for indices in parts(logs)]
        self._draft_of = {log: draft for draft in self._drafts for log in draft.logs}
        self.known = {
            log: reusable for log in logs if (reusable := self.earlier.find(log)) is not None
        }
        self.new = [log for log in logs if log not in self.known]
        self.missing = self.earlier.missing(logs)
        """The number of logs of the store that are not among those of this audit."""
        self.kept = 0
        """The number of logs that were audited here and whose results a later audit can reuse."""
        self._diagnostics: dict[Diagnostic, Diagnostic] = {}
        self._of_log: dict[str, tuple[Diagnostic, ...]] = {}
        self._read = 0
        self._next = time.monotonic() + _PATIENCE

    def __enter__(self) -> StoreWriter:
        """For as long as its results are read."""
        return self

    def __exit__(self, *_: object) -> None:
        """Remove the files that no manifest lists, and release the folder."""
        try:
            names = [name for name in (FILE, UNFINISHED) if (self.folder / name).exists()]
            manifests = [manifest(self.folder, name) for name in names]
            if not any(each is None or each.parts for each in manifests):
                remove(self.folder)
                if self._new_folder is not None:
                    with suppress(OSError):  # the folder is not empty
                        self._new_folder.rmdir()
            else:
                others = set() if self._is_finished else self._before
                remove_others(self.folder, *filter(None, manifests), kept=others)
        finally:
            self._lock.release()

    def run(self, engine: Engine, tell: Callable[[str], None]) -> StoredAudit | Diagnostic:
        """Audit the logs without reusable results, and write all results.

        Args:
            engine: the executor; the results do not depend on it.
            tell: is called with each log that was audited.
        """
        try:
            if not is_store(self.folder):  # a marker, so that only files of fretc are removed
                self._write(self._manifest([], UNFINISHED), UNFINISHED)
            self._take_over()
            with closing(engine(self._plan, self.new)) as items:
                for item in items:
                    if isinstance(item, Diagnostic):
                        self._keep()
                        return item
                    log, log_result = item
                    self._take(log, log_result)
                    tell(log)
                    self._keep_in_time()
            return self._finish()
        except KeyboardInterrupt:
            self._keep()
            raise
        except _WriteError as error:
            return error.diagnostic
        except StoreError as error:
            return error.diagnostic

    def _take_over(self) -> None:
        """Reuse the results of all known logs."""
        for log, known in self.known.items():
            entry = replace(known.entry, known_by=known.by)
            source = self._plan.declarations.source
            notes = tuple(self._one(diagnostic(each, source)) for each in entry.diagnostics)
            self._note(log, notes)
            self._draft_of[log].found[log] = _Log(entry, known=known)
            self._read += 1
        for draft in self._drafts:
            part = self.earlier.part(draft.logs, self.known)
            if part is not None:
                draft.part = part
                draft.entries = tuple(draft.found[log].entry for log in draft.logs)
                draft.found = {}
            else:
                self._complete(draft)

    def _take(self, log: str, own: LogResult) -> None:
        """Add the results of a log that was audited."""
        labelled_result = with_command_labels(self._plan, own)
        source = self._plan.declarations.source
        first = own.results[0]
        entry = Entry(
            run=first.run,
            log=log,
            place=os.path.realpath(log),
            known_by=own.known_by,
            sha256=first.fingerprints.log or "",
            **marks(own.stamp if own.read else None),
            labels=first.labels or {},
            diagnostics=tuple(
                diagnostic_text(diagnostic, source) for diagnostic in own.diagnostics
            ),
        )
        self._note(log, tuple(map(self._one, own.diagnostics)))
        self._read += own.read
        finished_log = _Log(entry, labelled_result.results)
        if sum(map(_events, labelled_result.results)) > _HEAVY:
            finished_log = _Log(entry, tables=to_tables(labelled_result.results, __version__))
        draft = self._draft_of[log]
        draft.found[log] = finished_log
        self._complete(draft)

    def _one(self, found: Diagnostic) -> Diagnostic:
        """The diagnostic, or an equal one that is already in memory."""
        return self._diagnostics.setdefault(found, found)

    def _note(self, log: str, notes: tuple[Diagnostic, ...]) -> None:
        if notes:
            self._of_log[log] = notes

    def _complete(self, draft: _PartDraft) -> None:
        """Write a part if all its logs are finished."""
        if len(draft.found) == len(draft.logs):
            draft.part = self._written(draft, draft.logs)
            draft.entries = tuple(draft.found[log].entry for log in draft.logs)
            draft.found = {}

    def _written(self, draft: _PartDraft, logs: Sequence[str]) -> Part:
        groups = list(self._grouped(draft.found[log] for log in logs))
        return _right(write_part(self.folder, joined(groups)))

    def _grouped(self, found: Iterator[_Log]) -> Iterator[Tables]:
        """The joined tables of all logs, in their order."""
        waiting: list[Result] = []
        for one in found:
            if one.tables is None:
                waiting += one.results if one.known is None else _results(self._plan, one.known)
                continue
            if waiting:
                yield to_tables(waiting, __version__)
                waiting = []
            yield one.tables
        if waiting:
            yield to_tables(waiting, __version__)

    # Manifests

    def _manifest(self, drafts: Sequence[tuple[Part, Sequence[Entry]]], name: str) -> StoreManifest:
        entries = [entry for _, some in drafts for entry in some]
        about = document(self._plan, (), ())
        new_manifest = StoreManifest(
            schema=SCHEMA,
            fretc=about.fretc,
            bindings=about.bindings,
            requirements=about.requirements,
            confidence=self._plan.confidence,
            parts=tuple(part for part, _ in drafts),
            register=_right(write_register(self.folder, entries)),
            selection=about.selection,
        )
        if name == UNFINISHED:
            return new_manifest
        provisional = Store(str(self.folder), "", new_manifest)
        estimates = estimates_of(self._plan, (each for _, each in provisional.briefs()))
        return replace(new_manifest, probabilities=estimates or UNSET)

    def _write(self, made: StoreManifest, name: str) -> str:
        """Write a manifest and the register that authenticates it."""
        digest = _right(write_manifest(self.folder, made, name))
        if self._key is not None:
            plan = self._plan
            names = self.folder, plan.key, keys(plan)
            content = vouched(*names, plan.labels, digest, self._key)
            wrong = write({self.folder / REUSE[name]: content})
            if wrong is not None:
                raise _WriteError(wrong)
        return digest

    def _keep_in_time(self) -> None:
        now = time.monotonic()
        if now >= self._next:
            self._keep()
            took = time.monotonic() - now
            self._next = time.monotonic() + max(_PATIENCE, _SHARE * took)

    def _keep(self) -> None:
        """Write the finished results, so that a later audit can reuse them."""
        if self._key is None:
            return
        finished_parts: list[tuple[Part, Sequence[Entry]]] = []
        for draft in self._drafts:
            if draft.part is not None:
                finished_parts.append((draft.part, draft.entries))
                continue
            logs = [log for log in draft.logs if log in draft.found]
            if logs:
                part = self._written(draft, logs)
                finished_parts.append((part, [draft.found[log].entry for log in logs]))
        self._write(self._manifest(finished_parts, UNFINISHED), UNFINISHED)
        entries = (entry for _, some in finished_parts for entry in some)
        self.kept = sum(entry.size is not None and entry.log not in self.known for entry in entries)

    def _finish(self) -> StoredAudit:
        finished_parts: list[tuple[Part, Sequence[Entry]]] = []
        for draft in self._drafts:
            assert draft.part is not None, "every log is finished"
            finished_parts.append((draft.part, draft.entries))
        final_manifest = self._manifest(finished_parts, FILE)
        entries = [entry for _, some in finished_parts for entry in some]
        store = Store(str(self.folder), "", final_manifest)
        if self._read:  # a mistyped name must not cost the evidence of the last audit
            store = Store(str(self.folder), self._write(final_manifest, FILE), final_manifest)
            self._is_finished = True
            for name in (UNFINISHED, REUSE[UNFINISHED]):
                (self.folder / name).unlink(missing_ok=True)
        estimates = tuple(store.probabilities)
        of_logs = [(entry.run, self._of_log.get(entry.log, ())) for entry in entries]
        said = diagnostics_of_all(self._plan, of_logs, store.tallies(), estimates)
        return StoredAudit(store, said, self._read, estimates)


T = TypeVar("T")


def _right(made: T | Diagnostic) -> T:
    if isinstance(made, Diagnostic):
        raise _WriteError(made)
    return made


def _events(result: Result) -> int:
    parts = (result.states, result.answers, result.triggers, result.latencies, result.open)
    return sum(map(len, parts)) + 50 * len(result.violations)


def busy(folder: Path) -> Diagnostic:
    """F912."""
    return Diagnostic(
        Code.BUSY,
        f"another audit is writing to `{folder}`",
        Source(str(folder), "").span(),
        help="wait until it ends, or name another folder with `-o`",
    )
