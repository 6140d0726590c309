"""A text that is proved is the one that Python runs."""

import pytest

from compiler.layout import is_utf8, strange
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
