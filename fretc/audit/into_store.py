"""An audit into a store: results are written as they are found, and unchanged logs are reused.

In memory are only the results of one log. Whatever ends the audit early, what is finished is in a
file beside the evidence, and the next audit takes it over.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import closing, suppress
from functools import cache, partial
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from sqlite3 import Error as SqliteError

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import UNSET, Raw, decoded, json_bytes, plain, replace
from compiler.files.templating import to_json
from compiler.files.text_files import destination
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
from fretc.audit.store import container, earlier_store
from fretc.audit.store.container import (
    FILE,
    PackedRun,
    Row,
    StoreError,
    bad_store,
    next_unfinished,
    packed,
    recovered,
    remove_file,
    unfinished,
    unpacked,
    whole_results,
)
from fretc.audit.store.reader import Store
from fretc.audit.store.recordings import KnownBy
from fretc.audit.store.register import (
    Authenticity,
    Entry,
    StoredPlan,
    diagnostic,
    diagnostic_text,
    marks,
)
from fretc.audit.store.writer import StoreFile, complete, not_written, publish, remove
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.system.files import FolderLock


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
    """A log of an earlier audit."""

    path: Path
    """The file with its results."""
    row: Row
    entry: Entry
    claims: Collection[str] | None
    """The requirements whose results are reusable; None: all."""
    has_same_labels: bool
    """Whether that audit gave all runs the same labels."""

    def results(self) -> tuple[Result, ...]:
        """Its reusable results; none if its file has been replaced."""
        try:
            (packed_run,) = _stored(self.path, [self.row])
            run = unpacked(self.row, packed_run.record, Raw)
            results = [*whole_results(run, range(self.row.results))]
        except SchemaError:
            return ()
        claims = self.claims
        return tuple(each for each in results if claims is None or each.requirement in claims)


def _stored(path: Path, rows: Sequence[Row]) -> Iterator[PackedRun]:
    """Some runs as a file holds them.

    Raises:
        SchemaError: the file has been replaced.
    """
    with container.opened(path) as connection:
        for row in rows:
            yield container.packed_run(connection, row)


class ReusableResults:
    """Reusable results of earlier audits: those that this user's key authenticates."""

    def __init__(self, folder: Path, plan: Plan, key: bytes | None, *, rehash: bool) -> None:
        """Read what earlier audits have written.

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
        self._logs: dict[str, _ReusableLog] = {}
        """The logs of audits with the same plan."""
        self.claims: set[str] = set()
        """The keys of requirements of another plan that are also in this one."""
        self._some: dict[str, _ReusableLog] = {}
        """The logs of audits with a plan that has some of the same requirements."""
        for path in (folder / FILE, *unfinished(folder)) if key is not None else ():
            assert key is not None
            with suppress(SchemaError):
                self._read(path, folder, key)

    def _read(self, path: Path, folder: Path, key: bytes) -> None:
        with container.opened(path) as connection:
            if not container.has_summaries(connection):
                self.stale = True
                return
            ((text,),) = connection.execute("SELECT plan FROM about LIMIT 2").fetchall()
            about = decoded(parsed(f"{text}"), StoredPlan) if text is not None else None
            entries = [*Authenticity.of(folder, f"{text}", key).entries(connection)]
        authentic = [(row, entry) for row, entry in entries if entry is not None]
        self.foreign |= len(authentic) < len(entries)
        if about is None or not authentic:
            return
        is_same = about.plan == self._plan.key
        claims: set[str] | None = None
        if not is_same:
            self.stale = True
            now = keys(self._plan)
            claims = {id for id, own in about.claims.items() if now.get(id) == own}
            self.claims |= claims
        has_same_labels = is_same and about.labels == dict(self._plan.labels)
        for row, entry in authentic if is_same or claims else ():
            log = _ReusableLog(path, row, entry, claims, has_same_labels)
            (self._logs if is_same else self._some)[entry.log] = log

    def missing(self, logs: Sequence[str]) -> int:
        """The number of known logs that are not among the given ones."""
        return len({*self._logs, *self._some}.difference(logs))

    def find(self, log: str) -> tuple[_ReusableLog, KnownBy] | None:
        """The reusable results of a log that is unchanged, and how that is known."""
        known = self._logs.get(log)
        by = known and known.entry.known_by_now(rehash=self._rehash)
        return (known, by) if known and by else None

    def results(self, log: str) -> tuple[Result, ...]:
        """The reusable results of a log from an audit with another plan."""
        return self._some[log].results() if log in self._some else ()


# The writer ------------------------------------------------------------------------------------


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
        self.folder, self._plan = folder, plan
        destination(folder / FILE)
        self._new_folder = None if folder.parent.exists() else folder.parent
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = FolderLock(folder)
        try:
            for path in unfinished(folder):
                if not recovered(path):
                    remove_file(path)
            self.earlier = ReusableResults(folder, plan, key, rehash=rehash)
        except BaseException:
            self._lock.release()
            raise
        self._stopped = unfinished(folder)
        """The files of audits that were stopped."""
        about = StoredPlan(plan.key, dict(keys(plan)), dict(plan.labels))
        self._about = to_json(plain(about))
        self._authenticity = None if key is None else Authenticity.of(folder, self._about, key)
        self._file: StoreFile | None = None
        self._places = {log: index for index, log in enumerate(logs)}
        found = {log: self.earlier.find(log) for log in logs}
        self.known = {log: known for log, known in found.items() if known is not None}
        self.new = [log for log in logs if log not in self.known]
        self.missing = self.earlier.missing(logs)
        """The number of logs of the store that are not among those of this audit."""
        self.kept = 0
        """The number of logs that were audited here and whose results a later audit can reuse."""
        self._diagnostics: dict[Diagnostic, Diagnostic] = {}
        self._of_log: dict[str, tuple[Diagnostic, ...]] = {}
        self._runs: dict[str, str] = {}
        self._read = 0

    def __enter__(self) -> StoreWriter:
        """For as long as its results are read."""
        return self

    def __exit__(self, *_: object) -> None:
        """Remove what no later audit can reuse, and release the folder."""
        try:
            if self._file is not None:
                with suppress(SqliteError):
                    self._file.discard()
                if not self._file.runs or self._authenticity is None or not self._read:
                    remove_file(self._file.path)
            if not (self.folder / FILE).exists() and not unfinished(self.folder):
                if not earlier_store.is_store(self.folder):
                    remove(self.folder)
                if self._new_folder is not None:
                    with suppress(OSError):  # the folder is not empty
                        self._new_folder.rmdir()
        finally:
            self._lock.release()

    def run(self, engine: Engine, tell: Callable[[str], None]) -> StoredAudit | Diagnostic:
        """Audit the logs without reusable results, and write all results.

        Args:
            engine: the executor; the results do not depend on it.
            tell: is called with each log that was audited.
        """
        try:
            self._file = StoreFile(next_unfinished(self.folder), self._about)
            self._take_over(self._file)
            with closing(engine(self._plan, self.new)) as items:
                for item in items:
                    if isinstance(item, Diagnostic):
                        return item
                    log, log_result = item
                    self._take(self._file, log, log_result)
                    tell(log)
            return self._finish(self._file)
        except SqliteError as error:
            return not_written(self.folder, error)
        except StoreError as error:
            return error.diagnostic
        except SchemaError as error:  # a file was replaced while it was read
            return bad_store(str(self.folder), f"cannot be read: {error}")
        finally:  # an interruption may have come after a run was written and before it was counted
            if self._file is not None and self._file.is_open:
                self.kept = self._file.reusable() - len(self.known)

    def _take_over(self, file: StoreFile) -> None:
        """Reuse the results of all known logs, in one transaction."""
        diagnostic_of = cache(partial(diagnostic, bindings=self._plan.declarations.source))
        file.connection.execute("BEGIN")
        for log, known, by, run in self._known_runs():
            entry = replace(known.entry, known_by=by)
            notes = tuple(self._one(diagnostic_of(each)) for each in entry.diagnostics)
            self._note(log, entry.run, notes)
            self._read += 1
            if known.has_same_labels:
                row = replace(known.row, place=self._places[log])
                self._put(file, entry, run._replace(row=row))
            else:
                own = entry.labels or UNSET
                results = tuple(replace(one, labels=own) for one in known.results())
                self._pack(
                    file, entry, with_command_labels(self._plan, LogResult(results, (), True))
                )
        file.connection.execute("COMMIT")
        for path in {known.path for known, _ in self.known.values()} & {*self._stopped}:
            remove_file(path)

    def _known_runs(self) -> Iterator[tuple[str, _ReusableLog, KnownBy, PackedRun]]:
        """Each known log with its run, file by file, in the order of the file.

        Raises:
            SchemaError: a file has been replaced.
        """
        known = [(one.path, one.row.place, log) for log, (one, _) in self.known.items()]
        for path, group in groupby(sorted(known), key=itemgetter(0)):
            logs = [log for _, _, log in group]
            runs = _stored(path, [self.known[log][0].row for log in logs])
            for log, run in zip(logs, runs, strict=True):
                yield log, *self.known[log], run

    def _take(self, file: StoreFile, log: str, own: LogResult) -> None:
        """Add the results of a log that was audited."""
        source = self._plan.declarations.source
        first = own.results[0]
        entry = Entry(
            run=first.run,
            log=log.encode("utf-8", "replace").decode(),
            place=os.path.realpath(log).encode("utf-8", "replace").decode(),
            known_by=own.known_by,
            sha256=first.fingerprints.log or "",
            **marks(own.stamp if own.read else None),
            labels=first.labels or {},
            diagnostics=tuple(
                diagnostic_text(diagnostic, source) for diagnostic in own.diagnostics
            ),
        )
        self._note(log, first.run, tuple(map(self._one, own.diagnostics)))
        self._read += own.read
        self._pack(file, entry, with_command_labels(self._plan, own), log)

    def _one(self, diagnostic: Diagnostic) -> Diagnostic:
        """The diagnostic, or an equal one that is already in memory."""
        return self._diagnostics.setdefault(diagnostic, diagnostic)

    def _note(self, log: str, run: str, notes: tuple[Diagnostic, ...]) -> None:
        self._runs[log] = run
        if notes:
            self._of_log[log] = notes

    def _pack(self, file: StoreFile, entry: Entry, own: LogResult, log: str | None = None) -> None:
        self._put(file, entry, packed(self._places[log or entry.log], own.results))

    def _put(self, file: StoreFile, entry: Entry, run: PackedRun) -> None:
        text = json_bytes(entry).decode()
        mark = None if self._authenticity is None else self._authenticity.mark(run.row, text)
        file.put(run, text, mark)

    def _finish(self, file: StoreFile) -> StoredAudit:
        head, rows = document(self._plan, (), ()), file.close()
        store = Store(str(self.folder), "", head, file.path, rows, by_summaries=True)
        estimates = estimates_of(self._plan, (each for _, each in store.summaries()))
        if self._read:  # a mistyped name must not cost the evidence of the last audit
            head = replace(head, probabilities=estimates or UNSET)
            sha256 = complete(file.path, head, rows)
            store = Store(
                str(self.folder), sha256, head, publish(file.path), rows, by_summaries=True
            )
            for path in self._stopped:
                remove_file(path)
            earlier_store.remove_tables(self.folder)
        of_logs = [(self._runs[log], self._of_log.get(log, ())) for log in self._places]
        said = diagnostics_of_all(self._plan, of_logs, store.tallies(), estimates)
        return StoredAudit(store, said, self._read, estimates)


def busy(folder: Path) -> Diagnostic:
    """F912."""
    return Diagnostic(
        Code.BUSY,
        f"another audit is writing to `{folder}`",
        Source(str(folder), "").span(),
        help="wait until it ends, or name another folder with `-o`",
    )
