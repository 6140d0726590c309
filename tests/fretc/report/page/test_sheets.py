import re

from fretc.report.page.sheets import quoted


def test_a_title_cannot_leave_its_string() -> None:
    assert quoted('a"; } <b>') == '"a\\22 \\3b  \\7d  \\3c b\\3e "'


def test_letters_of_other_alphabets_are_escaped() -> None:
    assert quoted("é 1") == '"\\e9  1"'


def test_a_browser_shows_each_blank_of_the_text() -> None:
    text = "agilex: 15 runs, 2 min, é  a"
    escape = re.compile(r"\\([0-9a-f]{1,6})\s?")  # CSS Syntax Level 3, section 4.3.7
    assert escape.sub(lambda found: chr(int(found[1], 16)), quoted(text)[1:-1]) == text
