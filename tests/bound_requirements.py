"""A sentence and the text of its bindings → the requirement that fretc makes of both."""

from __future__ import annotations

from functools import lru_cache

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

TABLES_OF_AGENT = """
[interceptor]
stop = "/stop"
command = "/c"
output = "/o"
period = "50 ms"
[action.do_stopped]
topic = "/stop"
type = "std_msgs/Bool"
message = { data = true }
[action.undo_stopped]
topic = "/stop"
type = "std_msgs/Bool"
message = { data = false }
"""
"""The tables of bindings that an agent needs which stops the robot if `stopped` is to hold."""


@lru_cache(maxsize=256)
def declared(text: str) -> Declarations:
    """What the text of bindings declares; it has no mistake."""
    found, wrong = read_bindings(Source("bindings.toml", text))
    assert found is not None, wrong
    assert wrong == (), wrong
    return found


@lru_cache(maxsize=4096)
def bound_requirement(sentence: str, bindings: str = "", id: str = "R1") -> FormalizedRequirement:
    """The requirement of a sentence with these bindings; equal ones are made once."""
    requirement = RequirementEntry(id, Source("r.fret", sentence).span())
    made, diagnostics = formalize(requirement, declared(bindings) if bindings else None)
    assert made is not None, diagnostics
    return made
