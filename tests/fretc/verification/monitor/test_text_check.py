"""A text that is proved is the one that Python runs."""

import ast
import random
from collections.abc import Iterator

import pytest

from fretc.verification.monitor.text_check import strange
from fretish.reading.text_encoding import is_utf8
from monitors.source_text import kernel
from tests.each import each
from tests.effort import FULL
from tests.monitoring import emitted

TEXT = emitted("whenever p c shall immediately satisfy q")
HIDDEN = '\n# \\u000aprint("hidden")\n'


@pytest.mark.parametrize(
    "cookie",
    [
        "# -*- coding: raw_unicode_escape -*-\n",
        "\r# vim: set fileencoding=utf-7 :\n",
        "# coding=x\n",
    ],
)
def test_a_text_that_python_reads_in_another_encoding_is_not_proved(cookie: str) -> None:
    assert "encoding" in (strange(cookie + TEXT + HIDDEN) or "")


@pytest.mark.parametrize("head", ["", "# coding: utf-8\n", "#\n#\n# coding: latin-1\n", "\ufeff"])
def test_utf_8_is_what_python_reads(head: str) -> None:
    assert is_utf8(head + TEXT)


def test_what_is_emitted_has_nothing_strange() -> None:
    assert strange(TEXT) is None


def pieces(tree: ast.Module) -> Iterator[tuple[ast.AST, str, list[ast.AST]]]:
    """All lists in a tree: statements, arguments, parts of tuples."""
    for node in ast.walk(tree):
        for name, value in ast.iter_fields(node):
            if isinstance(value, list) and value:
                yield node, name, value


HEAD, KERNEL, OWN = emitted("in m mode whenever p c shall within 3 ticks satisfy q").partition(
    kernel().text
)


def told_of(tree: ast.Module) -> str | None:
    try:
        text = ast.unparse(tree)
    except (ValueError, IndexError, AttributeError, RecursionError):  # it is no tree
        return None
    return strange(f"{HEAD}{KERNEL}\n{text}\n")


@pytest.mark.slow
@each("seed", range(60 if FULL else 5))
def test_whatever_is_left_out_of_a_text_or_swapped_it_is_told_in_words(seed: int) -> None:
    """Nothing, everything, the first or the last of any list; or one part for another."""
    choose = random.Random(seed)
    for rest in (slice(0, 0), slice(1, None), slice(None, -1), slice(0, 1), None):
        tree = ast.parse(OWN)
        node, name, value = choose.choice([*pieces(tree)])
        if rest is None:
            like = [other for _, kind, other in pieces(tree) if kind == name]
            value[choose.randrange(len(value))] = choose.choice(choose.choice(like))
        else:
            setattr(node, name, value[rest])
        reason_ = told_of(tree)
        assert reason_ is None or reason_.startswith(("it is", "what it does at a tick")), reason_
