"""Tables as files: equal tables give equal bytes, and untrusted files have limited cost."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow.parquet import ParquetFile, write_table

from compiler.files.checked_json import SchemaError
from fretc.audit.store.manifest import TableFile

LARGEST = 2**30
"""The most bytes of a table, as a file and in memory."""
ROWS = 2048
"""Rows of a row group, the unit that is decoded at once when a table is read by row."""
MOST_VALUES = 2**27
"""The most values of a column of a table, with nested ones."""


def encoded(table: pa.Table) -> tuple[bytes, TableFile]:
    """The file of a table, and its entry in a manifest."""
    stream = pa.BufferOutputStream()
    whole = table.combine_chunks()  # the bytes must not depend on its chunks
    write_table(whole, stream, compression="zstd", row_group_size=ROWS)
    data = stream.getvalue().to_pybytes()
    return data, TableFile(hashlib.sha256(data).hexdigest(), len(data), len(whole))


def content(path: Path, file: TableFile) -> bytes:
    """The bytes of a table.

    Raises:
        SchemaError: the bytes are not those that the manifest lists.
        OSError: the file cannot be read.
    """
    if file.size > LARGEST:
        raise SchemaError(f"`{path}` would be larger than {LARGEST // 2**20} MiB")
    with open(_opened(path), "rb") as stream:
        data = stream.read(file.size + 1)
    if len(data) != file.size or hashlib.sha256(data).hexdigest() != file.sha256:
        raise SchemaError(f"`{path}` is not the file that the manifest names")
    return data


def _opened(path: Path) -> int:
    """A descriptor of a regular file; neither the file nor its folder is a link."""
    own = os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW
    folder = os.open(path.parent, own | os.O_DIRECTORY)
    try:
        descriptor = os.open(path.name, own | os.O_NONBLOCK, dir_fd=folder)
    finally:
        os.close(folder)
    if stat.S_ISREG(os.fstat(descriptor).st_mode):
        return descriptor
    os.close(descriptor)
    raise OSError(errno.EINVAL, "it is not a regular file")


def decoded(
    data: bytes, file: TableFile, types: pa.Schema, columns: Sequence[str] | None = None
) -> pa.Table:
    """A table, or some of its columns.

    Raises:
        SchemaError: the file is not a table of this kind.
    """
    wanted = types.names if columns is None else [*columns]
    with _parquet(data, file, types) as parquet:
        there = [name for name in wanted if name in parquet.schema_arrow.names]
        return _with_later(parquet.read(there, use_threads=False), types, wanted)


LATER = frozenset({"situations", "unknown_inputs"})
"""Columns that the first stores do not have: they are read as unknown."""


def _with_later(table: pa.Table, types: pa.Schema, wanted: Sequence[str]) -> pa.Table:
    """The table with all wanted columns; those of `LATER` that it lacks are null."""
    for place, name in enumerate(wanted):
        if name not in table.schema.names:
            empty = pa.nulls(table.num_rows, types.field(name).type)
            table = table.add_column(place, types.field(name), empty)
    return table


@contextmanager
def _parquet(data: bytes, file: TableFile, types: pa.Schema) -> Iterator[ParquetFile]:
    try:
        with ParquetFile(pa.BufferReader(data)) as parquet:
            _check(parquet, file, types)
            yield parquet
    except (pa.ArrowException, OSError) as error:
        raise SchemaError(f"a table is damaged: {str(error).splitlines()[0]}") from None


@dataclass(frozen=True, slots=True)
class Rows:
    """A table that stays encoded: rows are decoded on demand, one row group after the other.

    The methods raise `SchemaError` if the file is not a table of its kind.
    """

    data: bytes
    file: TableFile
    types: pa.Schema

    @property
    def num_rows(self) -> int:
        """The number of rows."""
        return self.file.rows

    def __getitem__(self, column: str) -> pa.ChunkedArray:
        """One column of all rows."""
        return decoded(self.data, self.file, self.types, (column,))[column]

    def take(self, rows: pa.Array) -> pa.Table:
        """Some rows, in rising order."""
        wanted = rows.to_numpy()
        parts = [self.types.empty_table()]
        with _parquet(self.data, self.file, self.types) as parquet:
            for number, start, end in _spans(parquet):
                low, high = np.searchsorted(wanted, (start, end))
                if low < high:
                    of_group = parquet.read_row_group(number, use_threads=False)
                    of_group = _with_later(of_group, self.types, self.types.names)
                    parts.append(of_group.take(pa.array(wanted[low:high] - start)))
        return pa.concat_tables(parts)

    def groups(self) -> Iterator[pa.Table]:
        """All rows, some at a time."""
        with _parquet(self.data, self.file, self.types) as parquet:
            for number in range(parquet.num_row_groups):
                group = parquet.read_row_group(number, use_threads=False)
                yield _with_later(group, self.types, self.types.names)


def _spans(parquet: ParquetFile) -> Iterator[tuple[int, int, int]]:
    """Each row group with its first row and the row after its last one."""
    start = 0
    for number in range(parquet.num_row_groups):
        end = start + parquet.metadata.row_group(number).num_rows
        yield number, start, end
        start = end


def _check(parquet: ParquetFile, file: TableFile, types: pa.Schema) -> None:
    about = parquet.metadata
    if about.num_rows != file.rows:
        raise SchemaError("a table does not have as many rows as the manifest says")
    there = parquet.schema_arrow
    expected = [each for each in types if each.name in there.names or each.name not in LATER]
    if not there.equals(pa.schema(expected)):
        raise SchemaError("a table does not have the columns of this version of fretc")
    groups = [about.row_group(number) for number in range(about.num_row_groups)]
    chunks = [group.column(number) for group in groups for number in range(group.num_columns)]
    if sum(group.total_byte_size for group in groups) > LARGEST or any(
        chunk.num_values > MOST_VALUES for chunk in chunks
    ):
        raise SchemaError("a table is larger in memory than any that fretc writes")
