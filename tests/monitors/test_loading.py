"""A text is executed as it is, whatever of it is compiled once for all."""

from types import CodeType

import pytest

from monitors import loading
from monitors.loading import executed
from tests.monitoring import emitted

SENTENCE = "upon p the sw shall within 3 ticks satisfy q"
OWN = "# The requirements ---\n"


def lines(code: CodeType) -> list[tuple[str, int]]:
    """Each function and class, and its line."""
    inner = [const for const in code.co_consts if isinstance(const, CodeType)]
    return [(one.co_name, one.co_firstlineno) for one in inner] + [
        line for one in inner for line in lines(one)
    ]


def test_the_parts_of_a_monitor_have_the_lines_of_its_text() -> None:
    for text in (emitted(SENTENCE), emitted(SENTENCE, "the sw shall\nalways satisfy\nq")):
        parts = loading._compiled(text, "monitor")
        assert len(parts) == 2
        whole = lines(compile(text, "monitor", "exec"))
        assert sorted(line for part in parts for line in lines(part)) == sorted(whole)


def test_what_all_monitors_have_is_compiled_once() -> None:
    one, other = (loading._compiled(emitted(SENTENCE.replace("3", n)), n) for n in "34")
    assert one[0] is other[0]
    assert one[1] != other[1]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f'x = """\n{OWN}"""\n', OWN.join(("\n", ""))),
        (f"import sys\nx = (\n{OWN}  5)\n", 5),
        (f"import sys\nif 0:\n    x = 1\n{OWN}else:\n    x = 2\n", 2),
        (f"import sys\nif 1:\n    x = 1\n{OWN}    x = 3\n", 3),
        (f"x = 1\nimport sys\n{OWN}x += 3\n", 4),
        (f"# a\rx = 1\nimport sys\n{OWN}x += 4\n", 5),
        (f"# a\n{OWN}x = 6\n{OWN}x += 1\n", 7),
        (OWN + "x = 8", 8),
    ],
)
def test_a_text_that_cannot_be_divided_there_is_executed_as_it_is(text: str, found: object) -> None:
    assert executed(text, "other").x == found


def test_a_mistake_is_told_with_its_line() -> None:
    with pytest.raises(SyntaxError) as caught:
        executed(f"import sys\n\n{OWN}x = 1\n1 +\n", "other")
    assert caught.value.lineno == 5
