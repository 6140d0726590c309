"""What docs/explain.md shows is what the command prints."""

from pathlib import Path

from compiler.explanation.explain import explanation, text
from fretish.clock import Clock
from fretish.diagnostics import explanations
from fretish.diagnostics.diagnostic import Code
from tests.monitoring import requirement

DOCS = (Path(__file__).parent.parent.parent / "docs/explain.md").read_text("utf-8")
SENTENCE = "whenever too_close the robot shall within 200 milliseconds satisfy stopped"


def block(start: str) -> list[str]:
    """The indented lines from the first one that begins so, without their indent."""
    lines = DOCS[DOCS.index(f"    {start}") :].splitlines()
    shown = []
    for line in lines:
        if line and not line.startswith("    "):
            break
        shown.append(line.strip())
    return [line for line in shown if line]


def test_the_drawing_and_the_trace_are_printed() -> None:
    told = text(explanation(requirement(SENTENCE, "R2", Clock(100_000_000))))
    printed = [line.strip() for line in told.splitlines() if line.strip()]
    for start in ("tick   ", "✘ violated"):
        first, *_ = shown = block(start)
        at = printed.index(first)
        assert printed[at : at + len(shown)] == shown


def test_the_code_is_printed() -> None:
    told = explanations.text(Code.NO_TIMING)
    assert block("F205  ") == [line.strip() for line in told.splitlines() if line.strip()]
