"""The definition of the messages of a ROS 2 publisher, by its type and its type hash."""

from __future__ import annotations

import re

from fretc.logs.messages import ros2_types
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_SERVICE_EVENT = re.compile(r"\w+/srv/\w+_Event", re.ASCII)
_EVENT = "service_msgs/ServiceEventInfo info\n"
"""The first field of each event of a service, which is all that is read of it."""


def definition(type_: str, digest: str | None) -> str | None:
    """The definition with this hash; without a hash the only one; None: it is unknown.

    Raises:
        ModuleNotFoundError: rosbags is not installed.
    """
    if _SERVICE_EVENT.fullmatch(type_):
        return _EVENT
    definitions = ros2_types.definitions(type_)
    if digest is not None:
        return definitions.get(digest)
    return next(iter(definitions.values())) if len(definitions) == 1 else None


def no_definition(topic: str, type_: str, digest: str | None, missing: str) -> Diagnostic:
    """F958, with the reason why `definition` gives None.

    Args:
        topic: the topic.
        type_: the type of its messages.
        digest: the type hash, if there is one.
        missing: why nobody sends the definition of a type that is not of ROS 2 itself.
    """
    definitions = ros2_types.definitions(type_)
    if not definitions:
        why = f"is not a type of ROS 2 itself, and {missing}"
    elif digest is None:
        why = "differs between releases of ROS 2, and its publisher sends no type hash"
    else:
        why = "is defined differently by its publisher: the type hash differs"
    return diagnostic("no_message_definition", topic=topic, type=type_, why=why)
