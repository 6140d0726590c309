"""Tables as files: the same table gives the same bytes, and no stranger's file costs too much."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
from pyarrow.parquet import ParquetFile, write_table

from compiler.files.checked_json import MisshapenError
from fretc.audit.store.manifest import Table

LARGEST = 2**30
"""Bytes of a table, as a file and in memory."""
MOST_VALUES = 2**27
"""Values of a column of a table, with all that is nested."""


def encoded(table: pa.Table) -> tuple[bytes, Table]:
    """The file of a table, and what a manifest says of it."""
    stream = pa.BufferOutputStream()
    whole = table.combine_chunks()  # how it was put together must not show
    write_table(whole, stream, compression="zstd", row_group_size=max(1, len(whole)))
    data = stream.getvalue().to_pybytes()
    return data, Table(hashlib.sha256(data).hexdigest(), len(data), len(whole))


def content(path: Path, file: Table) -> bytes:
    """The bytes of a table.

    Raises:
        MisshapenError: they are not those that the manifest names.
        OSError: they cannot be read.
    """
    if file.size > LARGEST:
        raise MisshapenError(f"`{path}` would be larger than {LARGEST // 2**20} MiB")
    with open(_opened(path), "rb") as stream:
        data = stream.read(file.size + 1)
    if len(data) != file.size or hashlib.sha256(data).hexdigest() != file.sha256:
        raise MisshapenError(f"`{path}` is not the file that the manifest names")
    return data


def _opened(path: Path) -> int:
    """A descriptor of a regular file: neither it nor its folder is a link to somewhere else."""
    own = os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW
    folder = os.open(path.parent, own | os.O_DIRECTORY)
    try:
        descriptor = os.open(path.name, own | os.O_NONBLOCK, dir_fd=folder)
    finally:
        os.close(folder)
    if stat.S_ISREG(os.fstat(descriptor).st_mode):
        return descriptor
    os.close(descriptor)
    raise OSError(errno.EINVAL, "it is no regular file")


def decoded(
    data: bytes, file: Table, types: pa.Schema, columns: Sequence[str] | None = None
) -> pa.Table:
    """A table, or some of its columns.

    Raises:
        MisshapenError: it is none of this kind.
    """
    try:
        with ParquetFile(pa.BufferReader(data)) as parquet:
            _check(parquet, file, types)
            return parquet.read(columns=None if columns is None else list(columns))
    except (pa.ArrowException, OSError) as error:
        raise MisshapenError(f"a table is damaged: {str(error).splitlines()[0]}") from None


def _check(parquet: ParquetFile, file: Table, types: pa.Schema) -> None:
    about = parquet.metadata
    if about.num_rows != file.rows:
        raise MisshapenError("a table does not have as many rows as the manifest says")
    if not parquet.schema_arrow.equals(types):
        raise MisshapenError("a table does not have the columns of this version of fretc")
    groups = [about.row_group(number) for number in range(about.num_row_groups)]
    chunks = [group.column(number) for group in groups for number in range(group.num_columns)]
    if sum(group.total_byte_size for group in groups) > LARGEST or any(
        chunk.num_values > MOST_VALUES for chunk in chunks
    ):
        raise MisshapenError("a table is larger in memory than any that fretc writes")
