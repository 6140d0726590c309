"""Processes end with all that they have started, and a selector can wait for their output."""

import selectors
import subprocess
import sys
from collections.abc import Callable
from typing import IO, Any

import pytest

from fretish.system.processes import (
    OWN_GROUP,
    kill_all,
    selectable,
    through_socket,
    was_killed,
)
from tests.each import each

CHILD = """
import subprocess, sys
subprocess.Popen([sys.executable, "-c", "import time; print(7, flush=True); time.sleep(60)"])
import time; time.sleep(60)
"""


@pytest.mark.slow
def test_a_process_is_killed_with_its_children() -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", CHILD],
        stdout=subprocess.PIPE,
        start_new_session=True,
        creationflags=OWN_GROUP,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"7\n"
    kill_all(process)
    assert process.stdout.read() == b""  # the child's end of the pipe is closed, too
    assert was_killed(process.wait(10))
    process.stdout.close()
    kill_all(process)  # there is nothing any more


@each("reader", (selectable, through_socket))
def test_output_is_read_as_soon_as_it_comes(reader: Callable[[IO[bytes]], Any]) -> None:
    with subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as cat:
        assert cat.stdin is not None
        assert cat.stdout is not None
        with selectors.DefaultSelector() as selector:
            stream, read = reader(cat.stdout)
            selector.register(stream, selectors.EVENT_READ)
            assert selector.select(0) == []
            cat.stdin.write(b"one")
            assert selector.select(10)
            assert read(100) == b"one"
            cat.stdin.close()
            assert selector.select(10)
            assert read(100) == b""
        stream.close()
