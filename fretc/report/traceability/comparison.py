"""The difference between a project and its lock: nodes, links, verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fretc.report.traceability.chain import Node, Suspect
from fretc.report.traceability.lock import Lock, Standing

_MOST = 6
"""The most suspect links of one requirement that `text` prints."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One requirement in both states."""

    requirement: str
    state: str
    """`same`, `changed`, `new` (only now) or `gone` (only in the baseline)."""
    changes: tuple[tuple[Node, str], ...]
    """Each thing with `changed`, `new` or `gone`."""
    suspects: tuple[Suspect, ...]
    verdicts: tuple[tuple[str, str, str], ...]
    """Run, verdict in the baseline, verdict now; an empty word: none."""


def differences(standings: tuple[Standing, ...], baseline: Lock) -> tuple[Difference, ...]:
    """Every requirement of either state, in the order of the project, then those that are gone."""
    now = tuple(difference(standing) for standing in standings)
    ids = {standing.chain.requirement for standing in standings}
    return (*now, *(_removed(id, baseline) for id in baseline.reviews if id not in ids))


def difference(standing: Standing) -> Difference:
    """One requirement, against its review; `new` where it has none."""
    chain, review = standing.chain, standing.review
    if review is None:
        verdicts = _verdicts({}, chain.verdicts)
        return Difference(chain.requirement, "new", (), (), verdicts)
    changes = tuple((node, _how(node, chain.prints, review.prints)) for node in standing.changes)
    verdicts = _verdicts(review.verdicts, chain.verdicts)
    state = "changed" if changes or verdicts or standing.suspects else "same"
    return Difference(chain.requirement, state, changes, standing.suspects, verdicts)


def _removed(id: str, baseline: Lock) -> Difference:
    return Difference(id, "gone", (), (), _verdicts(baseline.reviews[id].verdicts, {}))


def _how(node: Node, now: Mapping[Node, str], before: Mapping[Node, str]) -> str:
    return "changed" if node in now and node in before else "new" if node in now else "gone"


def _verdicts(
    before: Mapping[str, str], now: Mapping[str, str]
) -> tuple[tuple[str, str, str], ...]:
    runs = sorted({*before, *now})
    pairs = [(run, before.get(run, ""), now.get(run, "")) for run in runs]
    return tuple(pair for pair in pairs if pair[1] != pair[2])


def as_record(difference: Difference) -> dict[str, Any]:
    """Plain values, in a fixed order of keys."""
    return {
        "requirement": difference.requirement,
        "state": difference.state,
        "changes": [{"thing": str(node), "how": how} for node, how in difference.changes],
        "suspect_links": [
            {
                "from": str(suspect.link.source),
                "to": str(suspect.link.target),
                "because_of": [str(cause) for cause in suspect.causes],
            }
            for suspect in difference.suspects
        ],
        "verdicts": [
            {"run": run, "before": before or None, "now": now or None}
            for run, before, now in difference.verdicts
        ],
    }


def text(difference: Difference) -> Iterator[str]:
    """Lines for a person."""
    states = {"same": "as it was reviewed", "new": "not reviewed", "gone": "not there any more"}
    yield f"{difference.requirement}  {states.get(difference.state, difference.state)}"
    for node, how in difference.changes:
        yield f"  {how:<8} {node.kind} {node.name}"
    for run, before, now in difference.verdicts:
        yield f"  verdict  {run}: {before or 'none'} → {now or 'none'}"
    links = difference.suspects
    for suspect in links[:_MOST]:
        causes = ", ".join(f"{cause.kind} {cause.name}" for cause in suspect.causes)
        yield f"  suspect  {_named(suspect.link.source)} → {_named(suspect.link.target)} ({causes})"
    if len(links) > _MOST:
        yield f"  suspect  and {len(links) - _MOST} more links"


def _named(node: Node) -> str:
    return f"{node.kind} {node.name}"
