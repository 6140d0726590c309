"""The status of the goals of an action of ROS 2, from messages of `NAME/_action/status`.

A message lists all goals that the server remembers. The text of this module is copied into emitted
nodes: it needs the standard library only.
"""

from collections.abc import Callable, Sequence
from typing import Any

from monitors.kernel.readings import Reading

STATUSES = ("none", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted")
"""The words of statuses; all but `none`, an empty list, have their numbers in
action_msgs/GoalStatus."""


def goal_status(
    message: Any,
    choice: str,
    wanted: "Sequence[str]" = (),
    field: "Callable[[Any, str], Any]" = getattr,
) -> Reading:
    """The status of goals in a message of type action_msgs/GoalStatusArray; None: unknown.

    Args:
        message: the message.
        choice: `latest`: the status of the goal that was accepted last, as a place in `STATUSES`;
            unknown if several were accepted at that time and differ. `any`, `all`: 1 if some goal
            has a wanted status, or all have one and there is one; else 0.
        wanted: words of statuses.
        field: reads a field by its name.

    Raises:
        AttributeError, TypeError: the message has another type.
    """
    goals = [
        (_nanoseconds(field(field(each, "goal_info"), "stamp"), field), int(field(each, "status")))
        for each in field(message, "status_list")
    ]
    if choice == "latest":
        last = max(goals, default=(0, 0))[0]
        statuses = {status for stamp, status in goals if stamp == last}
        if not statuses:
            return 0.0
        (status, *others) = statuses
        return None if others or not 0 < status < len(STATUSES) else float(status)
    if not all(0 < status < len(STATUSES) for _, status in goals):
        return None
    matches = [STATUSES[status] in wanted for _, status in goals]
    return float(any(matches) if choice == "any" else bool(matches) and all(matches))


def _nanoseconds(stamp: Any, field: "Callable[[Any, str], Any]") -> int:
    return int(field(stamp, "sec")) * 10**9 + int(field(stamp, "nanosec"))
