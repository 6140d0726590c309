"""Monitors of requirements: their text, and the monitor that it makes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol, cast

from compiler.formalization.formalize import duplicate_ids, name_collisions
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as python
from fretc.api.refusal import Refusal, bounded
from fretish.diagnostics.diagnostic import Code, Diagnostic
from monitors.kernel.stepping import Standing
from monitors.kernel.variables import Value
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


class Monitor(Protocol):
    """A generated monitor; docs/monitors.md says what its methods give."""

    PROPOSITIONS: Mapping[str, str]
    """Each proposition with its parameter: of `step`, where no sentence compares numbers."""

    @property
    def tick(self) -> int:
        """The last tick; -1 before the first."""

    def step(self, **values: Value) -> Verdict | tuple[Verdict, ...]:
        """One tick, by the value of each variable; None is unknown.

        Returns:
            A verdict, or of several requirements one for each.
        """

    def run(
        self, rows: Iterable[Sequence[Value] | Mapping[str, Value]]
    ) -> Verdict | tuple[Verdict, ...]:
        """Many ticks: the values of all variables in their order, or by their names."""

    def standings(self) -> tuple[Standing, ...]:
        """What would be said of each requirement if the trace ended now."""

    def verdicts(self) -> tuple[Verdict, ...]:
        """Of each requirement, whatever follows: satisfied or violated; or pending."""

    def state(self) -> dict[str, Any]:
        """Everything that is remembered, as plain values that JSON can hold."""

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state` gave; ValueError: it is of another monitor."""

    def reset(self) -> None:
        """Forget everything: the next step is tick 0."""


@bounded
def monitor_text(*requirements: FormalizedRequirement) -> str:
    """The text of one monitor for all of the requirements: a file that needs Python alone.

    Args:
        requirements: at least one, each with an id of its own; one that comes twice counts once.

    Raises:
        Refusal: a monitor cannot express one of them, or they do not fit into one file.
    """
    if not requirements:
        raise Refusal((_nothing(),))
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
    """The monitor of the requirements, compiled and ready to be stepped.

    Args, raises: as for `monitor_text`.
    """
    return cast(Monitor, load("monitor.py", monitor_text(*requirements)))


def _several_clocks(requirements: tuple[FormalizedRequirement, ...]) -> Iterable[Diagnostic]:
    first, *others = requirements
    for requirement in others:
        if requirement.clock != first.clock:
            yield Diagnostic(
                Code.BAD_USAGE,
                f"{requirement.id} and {first.id} are on two clocks: one monitor has one",
                requirement.entry.wording,
                help="formalize both with the same bindings",
            )


def _nothing() -> Diagnostic:
    return Diagnostic(
        Code.NOTHING_TO_DO, "a monitor needs a requirement", help="give one requirement or several"
    )
