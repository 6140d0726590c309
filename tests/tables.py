"""Tables for a generated monitor: mutated and hostile ones, and what they say by another way.

The other way is the modules csv and json, and the definition of the sentence.
"""

from __future__ import annotations

import csv
import importlib.util
import io
import json
import random
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from tests.readers import command, put

SENTENCE = "the sw shall always satisfy (p | q)\n"
N = 100_000
HOSTILE = {
    "no bytes": b"",
    "a line of nested lists": b'{"p": 1, "q": ' + b"[" * 100_000 + b"]" * 100_000 + b"}\n",
    "a line of nested objects": b'{"p":' * 20_000 + b"1" + b"}" * 20_000,
    "a value nested as deep as JSON is read": b'{"p": 1, "q": ' + b"[" * 900 + b"]" * 900 + b"}\n",
    "an integer of 4 300 digits": b'{"p": 1, "q": ' + b"1" * 4300 + b"}\n",
    "an integer of 100 000 digits": b'{"p": 1, "q": ' + b"1" * 100_000 + b"}\n",
    "a tick of many digits": b"tick,p,q\n" + b"1" * 4301 + b",1,1\n",
    "100 000 columns": b"".join(b"c%d," % i for i in range(N)) + b"p,q\n" + b"1," * N + b"1,0",
    "100 000 columns without a name": b"p,q" + b"," * 10**5 + b"\n1,1" + b"," * 10**5 + b"\n",
    "100 000 keys": b"{" + b",".join(b'"c%d":1' % i for i in range(10**5)) + b',"p":1,"q":0}\n',
    "zero bytes": b"p,q\n\0,1\n",
    "zero bytes in a header": b"p\0,q\n1,1\n",
    "zero bytes in another column": b"p,q,n\n1,1,\0\n",
    "a column of a terminal's commands": b"\x1b[2J\x1b[31m,q\n1,1\n",
    "a value of a terminal's commands": b"p,q\n\x1b]0;x\x07,1\n",
    "a header of several lines": b'"p\nt.csv: r: satisfied (1 trigger)",q\n1,1\n',
    "a value of several lines": b'p,q\n"0\nt.csv: r: satisfied (1 trigger)",1\n',
    "a key of several lines": b'{"p\\nr: satisfied": 1, "q": 1}\n',
    "a key of half a character": b'{"p\\ud800": 1, "q": 1}\n',
    "a value of half a character": b'{"p": "\\udfff", "q": 1}\n',
    "bytes of half a character": b"p,q\n\xed\xa0\x80,1\n",
    "a text that runs backwards": "p\u202e,q\n1,1\n".encode(),
    "a byte order mark": b"\xef\xbb\xbfp,q\n0,1\n",
    "two byte order marks": b"\xef\xbb\xbf\xef\xbb\xbfp,q\n0,1\n",
    "a byte order mark before a line": b"p,q\n\xef\xbb\xbf0,1\n",
    "UTF-16": "p,q\n0,1\n".encode("utf-16"),
    "a column twice": b"p,q,p\n1,0,0\n0,0,1\n",
    "a column twice but for spaces": b"p,q, p\n1,0,0\n",
    "a key twice": b'{"p": 0, "q": 0, "p": 1}\n',
    "a key twice by an escape": b'{"p": 0, "q": 0, "\\u0070": 1}\n',
    "a key twice in another value": b'{"p": 1, "q": 1, "n": {"a": 0, "a": 1}}\n',
    "a key twice in a later line": b'{"p": 1, "q": 0}\n{"p": 0, "q": 0, "q": 1}\n',
    "no number": b'{"p": NaN, "q": 1}\n',
    "an infinite number": b'{"p": 1, "q": -Infinity}\n',
    "a number beyond all": b'{"p": 1e999, "q": 1}\n',
    "a fraction": b'{"p": 1.0, "q": 0}\n',
    "minus nothing": b'{"p": -0, "q": -0}\n',
    "no number as a word": b"p,q\nnan,1\n",
    "a quote that never ends": b'p,q\n1,0\n"1,0\n0,0\n',
    "a header whose quote never ends": b'"p,q\n1,0\n',
    "a quote in the middle": b'p,q\n1"",0\n',
    "a value of 200 000 characters": b"p,q\n" + b"1" * 200_000 + b",0\n",
    "quotes": b"p,q\n" + b'"' * 99_999,
    "only a header": b"p,q\n",
    "only commas": b"," * 100_000,
    "blank lines": b"\n" * 100_000,
    "carriage returns": b"p,q\r0,1\r0,0\r",
    "rows of other lengths": b"p,q\n1,0,1\n",
    "a header in another case": b"P,Q\n1,1\n",
    "an object over several lines": b'{\n"p": 1,\n"q": 1}\n',
    "a list of objects": b'[{"p": 1, "q": 1}]\n',
    "a line that is no object": b'{"p": 1, "q": 1}\nnull\n',
    "two objects in a line": b'{"p": 1, "q": 1}{"p": 0, "q": 0}\n',
    "ticks that jump": b"tick,p,q\n0,1,1\n5,1,1\n",
    "a tick that is true": b'{"tick": true, "p": 1, "q": 1}\n',
}  # fmt: skip


class RefusedError(Exception):
    """The table says nothing: a monitor has to refuse it."""


def monitor(folder: Path) -> Callable[[list[str]], int]:
    """The generated monitor's own command."""
    put(folder, {"r.fret": SENTENCE})
    status, output, _ = command(folder, "r.fret", "--emit", "monitor")
    assert status == 0, output
    spec = importlib.util.spec_from_file_location("r_monitor", folder / "build/r_monitor.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    main, subject = module.main, module.MONITOR
    return lambda arguments: int(main(subject, arguments))


def hold(run: Callable[[list[str]], int], path: Path, data: bytes) -> str:
    """The monitor says what the table says, or refuses it in one line; its verdict.

    Raises:
        AssertionError: it does something else.
    """
    path.write_bytes(data)
    try:
        expected = verdict(rows(data))
    except RefusedError:
        expected = "refused"
    for engine in ("columns", "online"):
        status, out, complaint = _ran(run, [str(path), "--format", "json", "--engine", engine])
        if expected == "refused":
            assert (status, out) == (2, ""), f"{path}: {status} {out[:500]}"
            assert complaint.endswith("\n"), f"{path}: {complaint[:500]!r}"
            assert complaint[:-1].isprintable(), f"{path}: {complaint[:500]!r}"
            assert len(complaint) < 1000 + len(str(path)), f"{path}: {complaint[:500]!r}"
        else:
            assert not complaint, f"{path}: {expected}, but {complaint[:500]}"
            assert json.loads(out)["verdict"] == expected, f"{path}: {expected}, but {out[:500]}"
            assert status == {"satisfied": 0, "violated": 1, "no data": 3}[expected], path
    return expected


def _ran(run: Callable[[list[str]], int], arguments: list[str]) -> tuple[int, str, str]:
    out, errors = (io.TextIOWrapper(io.BytesIO(), "utf-8") for _ in range(2))
    with redirect_stdout(out), redirect_stderr(errors):
        status = run(arguments)
    texts = []
    for stream in (out, errors):
        stream.flush()
        assert isinstance(stream.buffer, io.BytesIO)
        texts.append(stream.buffer.getvalue().decode())
    return status, texts[0], texts[1]


# By another way

_TRUTH = {"": None, "0": False, "false": False, "1": True, "true": True}


def verdict(table: list[tuple[bool | None, ...]]) -> str:
    """By the definition of the sentence: at each tick one of the two is true."""
    ticks = [True if True in row else None if None in row else False for row in table]
    if False in ticks:
        return "violated"
    return "satisfied" if ticks and None not in ticks else "no data"


def rows(data: bytes) -> list[tuple[bool | None, ...]]:
    """What is said of p and q.

    Raises:
        RefusedError: nothing, or two things.
    """
    try:
        text = data.decode()
    except UnicodeDecodeError as error:
        raise RefusedError from error
    lines = list(io.StringIO(text.removeprefix("\ufeff"), newline=""))
    while lines and not lines[0].strip():
        del lines[0]
    if not lines:
        raise RefusedError
    start = "".join(lines[0].split())[:2]
    try:
        records = list(_objects(lines) if start in ('{"', "{}") else _records(lines))
    except (ValueError, RecursionError, csv.Error) as error:
        raise RefusedError from error
    _check_ticks([dict(pairs).get("tick", _NONE) for pairs in records])
    return [(_truth(pairs, "p"), _truth(pairs, "q")) for pairs in records]


_NONE = object()
Pairs = list[tuple[str, Any]]


def _objects(lines: list[str]) -> Iterator[Pairs]:
    for line in lines:
        if line.strip():
            pairs = json.loads(line, object_pairs_hook=_Pairs)
            if type(pairs) is not _Pairs:
                raise RefusedError
            yield pairs


class _Pairs(Pairs):
    """The pairs of an object, with each key once."""

    def __init__(self, pairs: Pairs) -> None:
        super().__init__(pairs)
        if len({key for key, _ in pairs}) < len(pairs):
            raise RefusedError


def _records(lines: list[str]) -> Iterator[Pairs]:
    table = csv.reader(lines, strict=True)
    header = [name.strip() for name in next(table)]
    for name in ("p", "q", "tick"):
        if header.count(name) not in ((0, 1) if name == "tick" else (1,)):
            raise RefusedError
    for values in table:
        if values and len(values) != len(header):
            raise RefusedError
        if values:
            yield list(zip(header, values, strict=True))


def _truth(pairs: Pairs, name: str) -> bool | None:
    found = dict(pairs)
    if name not in found:
        raise RefusedError
    value = found[name]
    if value is None or value is True or value is False:
        return value
    if type(value) not in (str, int):
        raise RefusedError
    try:
        return _TRUTH[str(value).strip().lower()]
    except (KeyError, ValueError) as error:
        raise RefusedError from error


def _check_ticks(ticks: list[Any]) -> None:
    if all(tick is _NONE for tick in ticks):
        return
    numbers = []
    for tick in ticks:
        digits = tick.strip().removeprefix("-") if isinstance(tick, str) else ""
        if type(tick) is not int and not (digits.isascii() and digits.isdigit()):
            raise RefusedError
        if len(str(tick).strip().removeprefix("-")) > 18:
            raise RefusedError
        numbers.append(int(tick))
    if numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        raise RefusedError


# Mutations

_SOUND = ("0", "1", "true", "false", " 1", '"1"', '""')
_VALUES = ('"', '""', "1e999", "NaN", "Infinity", "null", "-0", "0", "1", "true", "TRUE", "", " ",
           "\0", "\x1b[31m", "\ufeff", "\u202e", '"\\ud800"', "9" * 5000, "[" * 2000, '"a\nb"',
           "\r", '"p"', "p", "q", "tick", "{", "}", '{"a": 1, "a": 2}', "\u0661",
           "\u2003")  # fmt: skip


def mutated(chance: random.Random) -> bytes:
    """A table with cells, columns, keys or lines that are dropped, doubled, moved or changed."""
    sound = _objects_of(chance) if chance.random() < 0.5 else _records_of(chance)
    joint = ", " if sound.startswith("{") else ","
    table = [line.split(joint) for line in sound.splitlines(keepends=True)]
    for _ in range(chance.choice((0, 1, 1, 1, 2))):
        _change(table, chance)
    data = "".join(joint.join(line) for line in table).encode()
    if chance.random() < 0.1:
        at = chance.randrange(len(data) or 1)
        data = data[:at] + bytes([chance.randrange(256)]) + data[at + 1 :]
    return data


def _change(table: list[list[str]], chance: random.Random) -> None:
    line = chance.choice(table)
    at = chance.randrange(len(line)) if line else 0
    match chance.randrange(8):
        case 0:
            line[at : at + 1] = []
        case 1:
            line[at:at] = line[at : at + 1]
        case 2:
            line[at : at + 1] = [chance.choice(_VALUES)]
        case 3 if line:
            name, colon, _ = line[at].partition(": ")
            value = chance.choice(_VALUES if chance.random() < 0.5 else _SOUND)
            line[at] = f"{name}: {value}" if colon else value
        case 4:
            for each in table:  # a whole column
                each[at:at] = each[at : at + 1] * chance.choice((1, 1, 300))
        case 5:
            table.insert(chance.randrange(len(table)), list(line))
        case 6:
            table.insert(chance.randrange(len(table)), [chance.choice(_VALUES), "\n"])
        case _:
            order = chance.sample(range(len(line)), len(line))
            for each in table:
                if len(each) == len(order) and chance.random() < 0.95:
                    each[:] = [each[i] for i in order]


def _cells(chance: random.Random) -> Iterator[tuple[int, str, str]]:
    truths = chance.choice((("1",), ("0", "1"), ("1", "1", "")))
    for tick in range(8):
        yield tick, chance.choice(truths), chance.choice(truths)


def _records_of(chance: random.Random) -> str:
    if chance.random() < 0.3:
        return "tick,p,q,n\n" + "".join(f"{i},{p},{q},x\n" for i, p, q in _cells(chance))
    return "n,p,q,n\n" + "".join(f"x,{p},{q},x\n" for _, p, q in _cells(chance))


def _objects_of(chance: random.Random) -> str:
    count = '"tick": {}, ' if chance.random() < 0.3 else '"n": {}, '
    return "".join(
        f'{{"m": 0, {count.format(i)}"p": {p or "null"}, "q": {q or "null"}, "l": 0}}\n'
        for i, p, q in _cells(chance)
    )


def fuzzed(folder: Path, count: int, seed: int) -> dict[str, int]:
    """Feed it so many mutations; how often each verdict came.

    Raises:
        AssertionError: a verdict that is another one, or a refusal in another form.
    """
    run, chance = monitor(folder), random.Random(f"tables {seed}")
    found: dict[str, int] = {}
    for i in range(count):
        try:
            outcome = hold(run, folder / "t.csv", mutated(chance))
        except AssertionError as error:
            raise AssertionError(f"tables, seed {seed}, number {i}: {error}") from error
        found[outcome] = found.get(outcome, 0) + 1
    return found
