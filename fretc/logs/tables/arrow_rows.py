"""The rows of Parquet and Arrow IPC (Feather) files, read with pyarrow."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, BinaryIO

from fretc.logs.tables.rows import Row

PARQUET, ARROW = b"PAR1", b"ARROW1"
"""The first bytes of the files."""
EPISODE = "episode_index"
"""LeRobot's name of the column that tells the runs of a file apart."""
_ROWS = 10_000
"""Rows that are converted at once."""
_MOST_UNPACKED = 1000
"""How many times as large as the file its columns may say they are."""


def arrow_rows(
    stream: BinaryIO, size: int, episode: int | None = None
) -> tuple[Mapping[str, str], Iterator[Row]]:
    """The units of the columns of times, and the rows, the names of the columns first.

    Args:
        stream: the file.
        size: its bytes.
        episode: the run whose rows are wanted; None: all rows.

    Raises:
        ModuleNotFoundError: pyarrow is not installed.
        pyarrow.ArrowException: the file is damaged.
        ValueError: it says that it is much larger than it can be, or names no runs.
    """
    import pyarrow as pa
    from pyarrow import compute

    schema, batches = _opened(stream, size)
    if episode is not None:
        if EPISODE not in schema.names:
            raise ValueError(f"it has no column `{EPISODE}`")
        batches = (each.filter(compute.equal(each[EPISODE], episode)) for each in batches)
    times = [field.name for field in schema if pa.types.is_timestamp(field.type)]
    return dict.fromkeys(times, "ns"), _rows(schema.names, times, batches)


def episode_numbers(stream: BinaryIO, size: int) -> list[int]:
    """The runs that the rows of a file name, in their order; empty: it names none.

    Raises: as `arrow_rows`.
    """
    schema, batches = _opened(stream, size, EPISODE)
    if EPISODE not in schema.names:
        return []
    numbers = (number for batch in batches for number in batch[EPISODE].unique().to_pylist())
    return sorted({number for number in numbers if isinstance(number, int)})


def _opened(stream: BinaryIO, size: int, column: str | None = None) -> tuple[Any, Iterator[Any]]:
    """The schema and the batches of rows, of Parquet with one column alone if it is named."""
    import pyarrow as pa
    from pyarrow import ipc, parquet

    stream.seek(0)
    source = pa.PythonFile(stream, "r")
    if stream.read(len(PARQUET)) == PARQUET:
        file = parquet.ParquetFile(source)
        about = file.metadata
        groups = (about.row_group(i).total_byte_size for i in range(about.num_row_groups))
        if sum(groups) > _MOST_UNPACKED * size:
            raise ValueError("its columns say that they are impossibly large")
        wanted = [column] if column in file.schema_arrow.names else None
        return file.schema_arrow, file.iter_batches(_ROWS, columns=wanted)
    table = ipc.open_file(source)
    return table.schema, (table.get_batch(i) for i in range(table.num_record_batches))


def _rows(names: Sequence[str], times: Sequence[str], batches: Iterator[Any]) -> Iterator[Row]:
    import pyarrow as pa

    yield Row(0, names)
    number = 0
    try:
        for batch in batches:
            columns = [
                column.cast(pa.timestamp("ns", column.type.tz)).cast(pa.int64())
                if name in times
                else column
                for name, column in zip(names, batch.columns, strict=True)
            ]
            for cells in zip(*(column.to_pylist() for column in columns), strict=True):
                number += 1
                yield Row(number, [*map(_text, cells)], values=[*map(_json, cells)])
    except (pa.ArrowException, OSError) as error:
        yield Row(number + 1, (), str(error).partition("\n")[0][:200])


def _text(cell: object) -> str:
    return "" if cell is None else str(cell)


def _json(cell: object) -> str | None:
    return None if cell is None else json.dumps(cell, default=str)
