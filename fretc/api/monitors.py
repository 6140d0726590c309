"""Monitors of requirements: `monitor_text` and `load_monitor`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol, cast

from compiler.formalization.formalize import duplicate_ids, name_collisions
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as python
from fretc.api.refusal import Refusal, bounded
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.variables import Value
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


class Monitor(Protocol):
    """A generated monitor; docs/monitors.md describes its methods."""

    PROPOSITIONS: Mapping[str, str]
    """Proposition → parameter, of `step` if no sentence compares numbers."""

    @property
    def tick(self) -> int:
        """The last tick; -1 before the first."""

    def step(self, **values: Value) -> Verdict | tuple[Verdict, ...]:
        """Process one tick, from the value of each variable; None means unknown.

        Returns:
            The verdict, or the verdict of each requirement if there are several.
        """

    def run(
        self, rows: Iterable[Sequence[Value] | Mapping[str, Value]]
    ) -> Verdict | tuple[Verdict, ...]:
        """Process many ticks; a row has the values of all variables in order, or by name."""

    def statuses(self) -> tuple[RequirementStatus, ...]:
        """The verdict of each requirement if the trace ended now."""

    def verdicts(self) -> tuple[Verdict, ...]:
        """The final verdict of each requirement: satisfied, violated, or pending."""

    def state(self) -> dict[str, Any]:
        """The state of the monitor, as plain values for JSON."""

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from a state that `state` returned; ValueError if it is of another monitor."""

    def reset(self) -> None:
        """Return to the initial state: the next step is tick 0."""


@bounded
def monitor_text(*requirements: FormalizedRequirement) -> str:
    """The text of one monitor for all given requirements: a file that needs only Python.

    Args:
        requirements: at least one, with distinct ids; duplicates are ignored.

    Raises:
        Refusal: a monitor cannot express a requirement, or they do not fit into one file.
    """
    if not requirements:
        raise Refusal((diagnostic("no_requirement_for_monitor"),))
    requirements = tuple({id(requirement): requirement for requirement in requirements}.values())
    same_id = duplicate_ids([requirement.entry for requirement in requirements]).values()
    errors = [
        *filter(None, map(python.refuse, requirements)),
        *name_collisions(requirements),
        *dict.fromkeys(same_id),
        *_several_clocks(requirements),
    ]
    if errors:
        raise Refusal(errors)
    return python.text(*requirements)


def load_monitor(*requirements: FormalizedRequirement) -> Monitor:
    """A monitor for the requirements, ready to be stepped.

    Args, raises: as for `monitor_text`.
    """
    return cast(Monitor, load("monitor.py", monitor_text(*requirements)))


def _several_clocks(requirements: tuple[FormalizedRequirement, ...]) -> Iterable[Diagnostic]:
    first, *others = requirements
    for requirement in others:
        if requirement.clock != first.clock:
            yield diagnostic(
                "several_clocks",
                requirement.entry.wording,
                requirement=requirement.id,
                first=first.id,
            )
