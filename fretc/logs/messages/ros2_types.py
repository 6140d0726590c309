"""The definitions of the standard ROS 2 types in its releases."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any


def definitions(name: str) -> Mapping[str, str]:
    """Each definition that a standard ROS 2 type has in one of its releases, the oldest first.

    Args:
        name: `sensor_msgs/msg/LaserScan`.

    Returns:
        By its type hash (`RIHS01_...`) the text, with those of all types that it names; nothing
        where it is no such type. The hash tells definitions apart that differ in a field, or in
        one of a type within: https://ros.org/reps/rep-2016.html.

    Raises:
        ModuleNotFoundError: rosbags is not installed.
    """
    stores = [store for store in _stores() if name in store.fielddefs]
    store_of_hash = {store.hash_rihs01(name): store for store in stores}
    return {
        digest: str(store.generate_msgdef(name, ros_version=2)[0])
        for digest, store in store_of_hash.items()
    }


def standard(name: str) -> str | None:
    """The definition of a standard ROS 2 type, if it is equal in all releases.

    Raises:
        ModuleNotFoundError: rosbags is not installed.
    """
    texts = definitions(name)
    return next(iter(texts.values())) if len(texts) == 1 else None


def latest() -> Any:
    """The types of the latest release as a typestore of rosbags, which can encode messages.

    Raises:
        ModuleNotFoundError: rosbags is not installed.
    """
    return _stores()[-1]


def extended(fields: Mapping[str, str]) -> Any:
    """A typestore with the types of the latest release and further ones.

    Args:
        fields: the name of each further type (`example/msg/Name`) → its fields as text.

    Raises:
        ModuleNotFoundError: rosbags is not installed.
    """
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.LATEST)
    for name, text in fields.items():
        store.register(get_types_from_msg(text, name))
    return store


@cache
def _stores() -> tuple[Any, ...]:
    from rosbags.typesys import Stores, get_typestore

    return tuple(get_typestore(store) for store in Stores if store.name.startswith("ROS2_"))
