"""Names for propositions in languages that allow only plain identifiers."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from itertools import count, islice

from compiler.logic.printing import identifier, is_compound

_OPERATORS = {
    "<=": " le ", ">=": " ge ", "!=": " ne ", "<": " lt ", ">": " gt ", "=": " eq ",
    "+": " plus ", "-": " minus ", "*": " times ", "/": " over ", "^": " to ",
    "!": " not ", "&": " and ", "|": " or ", ".": "_",
}  # fmt: skip
_SYMBOL = re.compile("|".join(re.escape(symbol) for symbol in _OPERATORS))


def numbered(name: str) -> Iterator[str]:
    """`name`, `name_2`, `name_3` ..."""
    yield name
    yield from (f"{name}_{number}" for number in count(2))


def underlined(name: str) -> Iterator[str]:
    """`name`, `name_`, `name__` ..."""
    return (name + "_" * times for times in count())


def legal_names(
    propositions: Iterable[str],
    reserved: Container[str],
    prefix: str = "",
    names: Mapping[str, str] | None = None,
    *,
    variants: Callable[[str], Iterator[str]] = numbered,
    brings: Callable[[str], Iterable[str]] = lambda name: (name,),
) -> Mapping[str, str]:
    """A unique, unreserved identifier for each proposition, of letters, digits and `_`.

    A legal name is kept, whatever the others are: `init_2` stays beside `init`, which becomes
    `init_3`. Comparisons come last: `x_gt_3` keeps its name, and `(x > 3)` beside it becomes
    `x_gt_3_2`.

    Args:
        propositions: names of variables, and texts of comparisons and calls.
        reserved: the reserved names; case matters.
        prefix: the beginning of all names.
        names: preferred names of some propositions, used unless reserved.
        variants: yields a name and its replacements if it is taken.
        brings: all identifiers that a name introduces; none may be reserved or taken.
    """
    taken = set[str]()
    legal: dict[str, str] = {}

    def is_free(name: str) -> bool:
        return not any(identifier in reserved or identifier in taken for identifier in brings(name))

    everything = tuple(dict.fromkeys(propositions))
    wanted = {name: prefix + (names or {}).get(name, _plain(name)) for name in everything}
    # Where the reserved names are all that begin so, only another beginning helps.
    wanted = {
        name: f"v_{text}"
        if all(identifier in reserved for identifier in islice(variants(text), 3))
        else text
        for name, text in wanted.items()
    }

    def late(name: str) -> tuple[bool, bool]:
        return is_compound(name), wanted[name] != prefix + name or not is_free(wanted[name])

    for name in sorted(everything, key=late):
        legal[name] = next(filter(is_free, variants(wanted[name])))
        taken.update(brings(legal[name]))
    return {name: legal[name] for name in everything}


def _plain(name: str) -> str:
    """`x_gt_3` for `(x > 3)`; the result begins with a letter."""
    if is_compound(name):
        spelt = _SYMBOL.sub(lambda match: _OPERATORS[match[0]], name)
        name = "_".join(re.findall(r"\w+", spelt))
    text = identifier(name)
    return text if re.match("[A-Za-z]", text) else f"v_{text}"
