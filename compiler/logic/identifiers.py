"""Names for propositions in languages that know plain identifiers only."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

from compiler.logic.printing import identifier, is_compound

_OPERATORS = {
    "<=": " le ", ">=": " ge ", "!=": " ne ", "<": " lt ", ">": " gt ", "=": " eq ",
    "+": " plus ", "-": " minus ", "*": " times ", "/": " over ", "^": " to ",
    "!": " not ", "&": " and ", "|": " or ", ".": "_",
}  # fmt: skip
_SYMBOL = re.compile("|".join(re.escape(symbol) for symbol in _OPERATORS))


def legal_names(
    propositions: Iterable[str],
    reserved: Collection[str],
    prefix: str = "",
    names: Mapping[str, str] | None = None,
) -> Mapping[str, str]:
    """A name for each proposition: letters, digits and `_`, none of them twice or reserved.

    Names as they are come first: `x_gt_3` keeps its name, and the comparison `(x > 3)` beside it
    becomes `x_gt_3_2`.

    Args:
        propositions: names of variables, and texts of comparisons and calls.
        reserved: what a name may not be; capitals count.
        prefix: what all names begin with.
        names: what some propositions are called where that is not reserved.
    """
    taken = set(reserved)
    found: dict[str, str] = {}
    everything = tuple(dict.fromkeys(propositions))
    for name in sorted(everything, key=is_compound):
        wanted = prefix + (names or {}).get(name, _plain(name))
        found[name] = next(free for free in _variants(wanted) if free not in taken)
        taken.add(found[name])
    return {name: found[name] for name in everything}


def _plain(name: str) -> str:
    """`x_gt_3` for `(x > 3)`; it begins with a letter."""
    if is_compound(name):
        spelt = _SYMBOL.sub(lambda match: _OPERATORS[match[0]], name)
        name = "_".join(re.findall(r"\w+", spelt))
    text = identifier(name)
    return text if re.match("[A-Za-z]", text) else f"v_{text}"


def _variants(name: str) -> Iterable[str]:
    yield name
    number = 2
    while True:
        yield f"{name}_{number}"
        number += 1
