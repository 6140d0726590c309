"""The threat model speaks of every command, and of no other."""

import re
from pathlib import Path

from fretc.cli import cli
from fretc.terminal.group import DEFAULT

ROOT = Path(__file__).parent.parent.parent
DOCS = (ROOT / "docs/security.md").read_text("utf-8")


def test_each_command_has_its_row_with_what_it_reads() -> None:
    section = DOCS[DOCS.index("## What each command does") :].split("\n## ")[0]
    lines = re.findall(r"^\| (`.*) \|$", section, re.MULTILINE)
    table = [[cell.strip() for cell in line.split("|")] for line in lines]
    rows = {row[0].strip("`"): row[1] for row in table}
    assert len(rows) == len(table)
    assert rows.keys() == {
        "fretc FILE" if name == DEFAULT else f"fretc {name}" for name in cli.commands
    }
    assert all(rows.values())
    assert all(len(row) == 5 for row in table)
