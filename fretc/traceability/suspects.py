"""Links that a change since the review makes suspect, with the original changes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from fretc.traceability.chain import ADDED, DERIVED, REVIEW, Chain, ChainItem, Link
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Suspect:
    """A link that depends on an item that has changed since the review."""

    link: Link
    causes: tuple[ChainItem, ...]
    """The original changes upstream of the link, without changes that follow from them."""


def changed(
    prints: Mapping[ChainItem, str], locked: Mapping[ChainItem, str]
) -> tuple[ChainItem, ...]:
    """The nodes that were changed, added or removed since the lock, sorted."""
    return tuple(
        sorted(node for node in {*prints, *locked} if prints.get(node) != locked.get(node))
    )


def suspects(chain: Chain, locked: Mapping[ChainItem, str]) -> tuple[Suspect, ...]:
    """The links downstream of changes since the lock, those nearest to a change first.

    An outdated verdict or proof is suspect too, whatever the lock records: a verdict on changed
    bindings stays outdated when the reviewed bindings are restored.

    Args:
        chain: the present chain.
        locked: the fingerprints in the review.
    """
    prints, links, outdated_nodes = chain.prints, chain.links, chain.outdated
    changed_nodes = {
        node for node in changed(prints, locked) if node in locked or node.kind not in ADDED
    }
    late = outdated_nodes.keys() & locked.keys()
    if not changed_nodes and not late:
        return ()
    upstream = upstream_of(prints, links)
    causes_of: dict[Link, set[ChainItem]] = {}
    for link in links:
        above = {link.source, *upstream[link.source]}
        causes_of[link] = changed_nodes & above
        for node in late & above:
            causes_of[link] |= {*outdated_nodes[node]}
    for node in late:
        for source in outdated_nodes[node]:
            causes_of.setdefault(Link(source, node), set()).add(source)
    suspect = [
        Suspect(link, tuple(sorted(_first(causes_of[link], upstream))))
        for link in sorted(causes_of, key=lambda link: (len(upstream.get(link.source, ())), link))
        if causes_of[link]
    ]
    gone = tuple(sorted(node for node in locked if node not in prints))
    review = ChainItem(REVIEW, chain.requirement)
    suspect.extend(Suspect(Link(node, review), (node,)) for node in gone)
    return tuple(suspect)


def _first(
    causes: set[ChainItem], upstream: Mapping[ChainItem, frozenset[ChainItem]]
) -> Iterator[ChainItem]:
    """The causes that do not follow from another cause."""
    return (
        cause
        for cause in causes
        if cause.kind not in DERIVED or not upstream.get(cause, frozenset()) & causes
    )


def upstream_of(
    nodes: Iterable[ChainItem], links: Sequence[Link]
) -> dict[ChainItem, frozenset[ChainItem]]:
    """Each node → all nodes that lead to it."""
    above: dict[ChainItem, set[ChainItem]] = {node: set() for link in links for node in link}
    above |= {node: set() for node in nodes if node not in above}
    for link in links:
        above[link.target].add(link.source)
    upstream: dict[ChainItem, frozenset[ChainItem]] = {}

    def reach(node: ChainItem) -> frozenset[ChainItem]:
        if node not in upstream:
            upstream[node] = frozenset()  # A requirement may be its own ancestor.
            upstream[node] = frozenset(above[node]).union(
                *(reach(source) for source in above[node])
            )
        return upstream[node]

    for node in above:
        reach(node)
    return upstream
