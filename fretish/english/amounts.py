"""Numbers with units, and durations, as people write them."""

from __future__ import annotations

from fractions import Fraction

from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.clock import SYMBOL_OF, whole_duration
from fretish.english.words import Phrase, Places, places
from fretish.units import unit

_NUMBERS = {
    word: str(value)
    for value, word in enumerate(
        "zero one two three four five six seven eight nine ten eleven twelve".split()
    )
}
_TIMES: dict[str, s.TimeUnit] = {
    **dict.fromkeys("tick ticks step steps cycle cycles frame frames".split(), "tick"),
    **dict.fromkeys("us microsecond microseconds microsec".split(), "microsecond"),
    **dict.fromkeys("ms msec msecs millisecond milliseconds".split(), "millisecond"),
    **dict.fromkeys("s sec secs second seconds".split(), "second"),
    **dict.fromkeys("min mins minute minutes".split(), "minute"),
    **dict.fromkeys("h hour hours".split(), "hour"),
}
_UNITS = {
    "percent": "%", "°": "deg", "degree": "deg", "degrees": "deg", "radian": "rad",
    "radians": "rad", "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "centimeters": "cm", "centimetres": "cm", "centimeter": "cm", "centimetre": "cm",
    "millimeters": "mm", "millimetres": "mm", "kilometers": "km", "kilometres": "km",
    "feet": "ft", "foot": "ft", "knots": "kn", "volt": "V", "volts": "V", "ampere": "A",
    "amperes": "A", "amps": "A", "watt": "W", "watts": "W", "kelvin": "K", "hertz": "Hz",
    "newton": "N", "newtons": "N", "pascal": "Pa", "gram": "g", "grams": "g", "kilograms": "kg",
    "second": "s", "seconds": "s", "sec": "s", "minutes": "min", "minute": "min", "hours": "h",
    "hour": "h", "milliseconds": "ms",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Time:
    """A duration, the places of its words, and the index of the word after it."""

    duration: s.Duration
    used: Places
    end: int

    @property
    def amount(self) -> e.Expression:
        """The duration as an argument of a predicate: `100`, or `5 s`."""
        digits = str(self.duration.amount)
        if self.duration.unit == "tick":
            return e.Number(digits)
        return e.Quantity(digits, SYMBOL_OF[self.duration.unit])


def digits_of(phrase: Phrase, index: int) -> str | None:
    """The number at a place, in digits; None if there is none."""
    if not 0 <= index < len(phrase):
        return None
    word = phrase[index]
    return word.text if word.is_number else _NUMBERS.get(word.lower)


def time_at(phrase: Phrase, index: int) -> Time | None:
    """The duration that begins at a place: `5 seconds`, `a minute`, `200ms`; None: none does."""
    if index >= len(phrase):
        return None
    digits = digits_of(phrase, index)
    if digits is None and phrase[index].lower in ("a", "an"):
        digits = "1"
    glued = phrase[index].text
    number = glued.rstrip("abcdefghijklmnopqrstuvwxyz")
    if digits is None and number != glued and number.replace(".", "", 1).isdigit():
        return _time(number, glued[len(number) :], phrase, index, index + 1)
    if digits is None or index + 1 >= len(phrase):
        return None
    return _time(digits, phrase[index + 1].lower, phrase, index, index + 2)


def _time(digits: str, name: str, phrase: Phrase, start: int, end: int) -> Time | None:
    if name not in _TIMES or digits.startswith("-"):
        return None
    duration = whole_duration(Fraction(digits), _TIMES[name])
    return None if duration is None else Time(duration, places(phrase[start:end]), end)


def amount_in(phrase: Phrase) -> tuple[e.Expression, Places, int] | None:
    """The only number of a phrase with its unit, the words used, and the index after it.

    None: there is none, or there are several. A number in parentheses after words counts, so that
    "the capability (50 deg/s2)" is 50 deg/s2.
    """
    starts = [i for i in range(len(phrase)) if digits_of(phrase, i) is not None]
    spans = [(i, *_quantity(phrase, i)) for i in starts]
    if len(spans) != 1:
        return None
    start, expression, end = spans[0]
    return expression, places(phrase[start:end]), end


def _quantity(phrase: Phrase, index: int) -> tuple[e.Expression, int]:
    """The number at a place with its unit if that is known, and the index after it."""
    digits = digits_of(phrase, index)
    assert digits is not None
    negative, end = digits.startswith("-"), index + 1
    digits = digits.lstrip("-")
    value: e.Expression = e.Number(digits)
    name, after = _unit_at(phrase, end)
    if name:
        value, end = e.Quantity(digits, name), after
    return (e.Negation(value) if negative else value), end


def _unit_at(phrase: Phrase, index: int) -> tuple[str, int]:
    """The unit at a place, and the index after it; empty: there is none."""
    if index >= len(phrase):
        return "", index
    name = _unit(phrase[index].text)
    per = [word.lower for word in phrase[index + 1 : index + 3]]
    if name and len(per) == 2 and per[0] in ("per", "/") and _unit(phrase[index + 2].text):
        return f"{name}/{_unit(phrase[index + 2].text)}", index + 3
    return name, index + 1


def _unit(text: str) -> str:
    plain = _UNITS.get(text.lower(), text.replace("sec", "s"))
    return plain if plain != "1" and unit(plain) is not None else ""
