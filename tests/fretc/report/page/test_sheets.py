from fretc.report.page.sheets import quoted


def test_a_title_cannot_leave_its_string() -> None:
    assert quoted('a"; } <b>') == '"a\\000022\\00003b \\00007d \\00003cb\\00003e"'


def test_letters_of_other_alphabets_are_escaped() -> None:
    assert quoted("é 1") == '"\\0000e9 1"'
