"""SOURCE_DATE_EPOCH, as reproducible-builds.org has it."""

from datetime import UTC, datetime

import pytest

from compiler.files.dates import source_date


@pytest.mark.parametrize(
    ("epoch", "expected"),
    [
        ("0", datetime(1970, 1, 1, tzinfo=UTC)),
        ("1790000000", datetime(2026, 9, 21, 14, 13, 20, tzinfo=UTC)),
        ("", None),
        ("-1", None),
        ("1e9", None),
        ("today", None),
        ("1" * 30, None),
    ],
)
def test_the_date_is_the_one_that_is_set(
    monkeypatch: pytest.MonkeyPatch, epoch: str, expected: datetime | None
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    assert source_date() == expected


def test_there_may_be_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert source_date() is None
