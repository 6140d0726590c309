"""Truth with unknowns, verdicts, and what of a requirement is watched at each tick."""

from enum import Enum
from typing import Any, Generic, NamedTuple, TypeVar

Truth = bool | None
"""True, False, or None: unknown."""


def boolean(value: object, name: str = "") -> bool:
    """A truth value that is not unknown, as Python has it: NumPy's Boolean, too.

    Raises:
        TypeError: it is something else.
    """
    if type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    subject = f"`{name}`" if name else "a truth value"
    raise TypeError(f"{subject} is True, False or None (unknown), not {value!r}")


class Verdict(str, Enum):  # Python 3.10 has no StrEnum
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
    """A demand begins here."""
    breach: Any
    """A demand is broken here: nothing that follows can repair it."""
    doom: Any
    """Demands are open here that no endless trace meets, though none of them is broken yet."""
    owed: Any
    """A demand is open after this tick (where none has been broken before)."""
    fails: Any
    """The trace would violate the requirement if it ended here, though nothing is broken yet."""
    settled: Any
    """Nothing that follows can break a demand any more."""
    answer: Any
    """The response comes here, where a demand waits for one."""


class Signals(_Signals, Generic[T]):
    """A monitor's signals of one requirement: a truth value a tick, or whole columns of them.

    Each is a `T`; in Python 3.10 no NamedTuple can say so itself.
    """

    __slots__ = ()


class Requirement(NamedTuple):
    """Which requirement a monitor watches."""

    id: str
    sentence: str
    fingerprint: str
    """SHA-256 of the canonical sentence."""
    horizon: int | None
    """Ticks from a trigger to its deadline; None where there is no deadline."""


def truth(must: bool, may: bool) -> Truth:
    """What holds for certain and what may hold, as one truth value."""
    return must if must == may else None


def at_end(broken: Truth, owed: Truth, triggered: Truth) -> Verdict:
    """The verdict of a trace that ends here."""
    if broken is not False:
        return VIOLATED if broken else NO_DATA
    if owed is not False:
        return INCONCLUSIVE if owed else NO_DATA
    if triggered is not False:
        return SATISFIED if triggered else NO_DATA
    return VACUOUS
