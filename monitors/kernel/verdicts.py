"""Three-valued truth, verdicts, and the signals of a requirement at each tick."""

from collections.abc import Sized
from enum import Enum
from typing import Any, Generic, NamedTuple, Optional, TypeVar

Truth = Optional[bool]
"""True, False, or None: unknown."""


def boolean(value: object, name: str = "") -> bool:
    """A Python `bool` from a `bool` or a NumPy Boolean.

    Raises:
        TypeError: the value is neither.
    """
    if type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    subject = f"`{name}`" if name else "a truth value"
    raise TypeError(f"{subject} is True, False or None (unknown), not {value!r}")


class Verdict(str, Enum):  # Python 3.8 has no StrEnum
    """The judgement of a trace on a requirement.

    While it runs: satisfied or violated, whatever follows, or pending (LTL3). When it has ended:
    satisfied, violated, inconclusive, vacuous or no data. Source: Bauer, Leucker, Schallhart,
    Runtime verification for LTL and TLTL, TOSEM 20 (2011), section 2.
    """

    SATISFIED = "satisfied"
    VIOLATED = "violated"
    PENDING = "pending"
    INCONCLUSIVE = "inconclusive"
    VACUOUS = "vacuous"
    NO_DATA = "no data"

    __str__ = str.__str__
    __format__ = str.__format__  # type: ignore[assignment]


SATISFIED, VIOLATED, PENDING = Verdict.SATISFIED, Verdict.VIOLATED, Verdict.PENDING
INCONCLUSIVE, VACUOUS, NO_DATA = Verdict.INCONCLUSIVE, Verdict.VACUOUS, Verdict.NO_DATA
EXIT_STATUS = {SATISFIED: 0, VIOLATED: 1, INCONCLUSIVE: 3, VACUOUS: 3, NO_DATA: 3}

T = TypeVar("T")


class _Signals(NamedTuple):
    trigger: Any
    """An obligation begins at this tick."""
    violation: Any
    """An obligation is violated at this tick, for every continuation."""
    violation_inevitable: Any
    """No infinite continuation meets the open obligations, though none is violated yet."""
    obligation_pending: Any
    """An obligation is open after this tick (if none was violated before)."""
    violated_if_ended: Any
    """The trace would violate the requirement if it ended here, though nothing is violated yet."""
    satisfied_forever: Any
    """No continuation can violate the requirement."""
    answer: Any
    """The response to a pending obligation is true at this tick."""


class Signals(_Signals, Generic[T]):
    """A monitor's signals of one requirement: truth values at a tick, or columns of them.

    Each field is a `T`; a NamedTuple cannot be generic in Python 3.8.
    """

    __slots__ = ()


class Requirement(NamedTuple):
    """A requirement of a monitor."""

    id: str
    sentence: str
    fingerprint: str
    """SHA-256 of the canonical sentence."""
    deadline_ticks: "int | None"
    """Ticks from a trigger to its deadline; None if there is no deadline."""


def same_length(*parts: Sized) -> None:
    """Check what `zip(strict=True)` checks, which Python 3.8 does not have.

    Raises:
        ValueError: a part has more or fewer items than another.
    """
    if len({*map(len, parts)}) > 1:
        raise ValueError("there are more or fewer values than expected")


def truth(certain: bool, possible: bool) -> Truth:
    """The three-valued truth value of a certain (`certain`) and a possible (`possible`) value."""
    return certain if certain == possible else None


def at_end(broken: Truth, pending: Truth, triggered: Truth) -> Verdict:
    """The verdict on a trace that ends at this tick."""
    if broken is not False:
        return VIOLATED if broken else NO_DATA
    if pending is not False:
        return INCONCLUSIVE if pending else NO_DATA
    if triggered is not False:
        return SATISFIED if triggered else NO_DATA
    return VACUOUS
