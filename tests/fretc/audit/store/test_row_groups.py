import numpy as np
import pyarrow as pa
import pytest

from compiler.files.checked_json import SchemaError
from fretc.audit.store import files

COUNT = 2 * files.ROWS + 3
TYPES = pa.schema([("number", pa.int64()), ("text", pa.string())])


def encoded() -> tuple[pa.Table, files.Rows]:
    numbers = range(COUNT)
    table = pa.table([[*numbers], [f"row {n}" for n in numbers]], schema=TYPES)
    data, file = files.encoded(table)
    return table, files.Rows(data, file, TYPES)


def test_a_group_of_rows_is_bounded_and_all_of_them_are_the_table() -> None:
    table, rows = encoded()
    groups = [*rows.groups()]
    assert max(map(len, groups)) == files.ROWS
    assert pa.concat_tables(groups).equals(table)


@pytest.mark.parametrize("seed", range(5))
def test_rows_taken_from_an_encoded_table_are_those_of_the_table(seed: int) -> None:
    table, rows = encoded()
    chosen = np.flatnonzero(np.random.default_rng(seed).random(COUNT) < 0.01)
    edges = [0, files.ROWS - 1, files.ROWS, COUNT - 1]
    for some in ([], edges, chosen.tolist()):
        places = pa.array(some, pa.int64())
        assert rows.take(places).equals(table.take(places))
    assert rows["text"].equals(table["text"])
    assert rows.num_rows == table.num_rows


def test_an_encoded_table_is_held_against_the_manifest() -> None:
    _, rows = encoded()
    other = files.Rows(rows.data, rows.file, pa.schema([("number", pa.int64())]))
    with pytest.raises(SchemaError, match="columns"):
        other.take(pa.array([0]))
    with pytest.raises(SchemaError, match="damaged"):
        next(files.Rows(b"PAR1", rows.file, TYPES).groups())
