"""Results as annotations of GitHub Actions."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.schema import Result
from fretc.audit.outputs.github import github
from tests.fretc.audit import results
from tests.monitoring import requirement


def result(verdict: str, **more: Any) -> Result:
    return results.result(requirement="R1", verdict=verdict, **{"run": "a.mcap", **more})


@pytest.mark.parametrize(
    ("verdict", "level"),
    [
        ("satisfied", "notice"),
        ("violated", "error"),
        ("inconclusive", "warning"),
        ("vacuous", "warning"),
        ("no data", "warning"),
    ],
)
def test_an_annotation_stands_at_the_sentence(verdict: str, level: str) -> None:
    lines = github([result(verdict)], [requirement("the sw shall always satisfy q").entry])
    assert lines == f"::{level} file=r.fret,line=1,title=R1 {verdict}::a.mcap: why\n"


@given(st.text())
def test_nothing_in_a_result_makes_another_annotation_or_moves_the_cursor(text: str) -> None:
    evil = result("violated", run=f"a\n::error::{text}", reason=f"100%\r\n{text}")
    lines = github([evil], [requirement("the sw shall always satisfy q").entry])
    assert lines[:-1].isprintable()
    assert lines.startswith("::error file=r.fret,line=1,title=R1 violated::a\\n::error::")
    assert "100%25\\r\\n" in lines
