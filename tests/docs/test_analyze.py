"""The example of docs/analyze.md is what the command prints."""

import re

import pytest

from fretc.analysis.text_output import lines
from tests.docs.pages import is_current
from tests.requirement_sets import analyzed, roles


def printed(subject: str) -> str:
    """`start, stop -> run; SENTENCE; SENTENCE`, and what is printed of these."""
    named, *sentences = subject.split("; ")
    inputs, outputs = (part.split(", ") for part in named.split(" -> "))
    found = analyzed(*sentences, roles=roles(inputs, outputs), repairs=True)
    written = {f"R{i}": sentence for i, sentence in enumerate(sentences, 1)}
    return "\n".join(f"    {line}".rstrip() for line, _ in lines(found, written))


def test_the_example_is_what_is_printed(request: pytest.FixtureRequest) -> None:
    is_current("analyze.md", {"analysis": printed}, request)


def test_every_key_of_the_json_is_told() -> None:
    from fretc.analysis.findings import Analysis
    from tests.docs.pages import FOLDER

    page = (FOLDER / "analyze.md").read_text("utf-8")
    told = set(re.findall(r"`(\w+)`", page.partition("## As JSON")[2]))
    assert {*Analysis.__struct_fields__} - {"schema", "fretc"} <= told
