"""Statements: what is read is what fretc writes, and nothing else."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from compiler.files.checked_json import SchemaError
from fretc.attestation.statement import REVIEW, SignedItem, Statement, read, text

ONE = Statement(REVIEW, (SignedItem(REVIEW, "R1:a", "ab" * 32), SignedItem(REVIEW, "", "cd" * 32)))


def test_what_is_written_is_read_again() -> None:
    assert read(text(ONE)) == ONE


def changed(change: Callable[[dict[str, Any]], object]) -> bytes:
    content = json.loads(text(ONE))
    change(content)
    return json.dumps(content).encode()


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(_type="https://in-toto.io/Statement/v0.1"),
        lambda content: content.update(predicateType="urn:fretc:review:2"),
        lambda content: content.update(predicateType="urn:fretc:log:1"),
        lambda content: content.update(predicateType="urn:fretc:evidence:1"),
        lambda content: content.update(more=1),
        lambda content: content.pop("predicate"),
        lambda content: content.update(predicate=[]),
        lambda content: content.update(subject={}),
        lambda content: content["subject"][0].update(name="R1"),
        lambda content: content["subject"][0].update(name="waiver:R1"),
        lambda content: content["subject"][0].update(uri="x"),
        lambda content: content["subject"][0]["digest"].update(sha1="00"),
        lambda content: content["subject"][0].update(digest={"sha1": "00"}),
        lambda content: content["subject"][0]["digest"].update(sha256="AB" * 32),
        lambda content: content["subject"][0]["digest"].update(sha256="ab" * 31),
    ],
)
def test_another_statement_is_refused(change: Callable[[dict[str, Any]], object]) -> None:
    with pytest.raises(SchemaError):
        read(changed(change))


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xff",
        b"[" * 100_000,
        b'{"_type": NaN}',
        text(ONE).replace(b'"_type"', b'"_type": 1, "_type"', 1),
    ],
)
def test_what_is_no_plain_json_is_refused(payload: bytes) -> None:
    with pytest.raises(SchemaError):
        read(payload)
