"""Classes of standard ROS 2 messages, made at run time from the definitions in the rosbags package."""

from __future__ import annotations

import os
from functools import cache
from typing import TYPE_CHECKING

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.core.messages import Message
from roverlink.runtime.recording.message_definitions import message_type_from

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


def full_name(type_name: str) -> str:
    """Return ``sensor_msgs/msg/Imu`` for ``sensor_msgs/Imu`` or for itself. Raises `SetupError` for any other form."""
    parts = type_name.split("/")
    if len(parts) == 2:
        parts.insert(1, "msg")
    if len(parts) != 3 or not all(parts):
        raise SetupError(f"{type_name!r} is not the name of a ROS 2 type, such as sensor_msgs/msg/Imu")
    return "/".join(parts)


@cache
def message_type(type_name: str) -> type[Message]:
    """Return the class of a standard message by its full name. Raises `SetupError` for one that rosbags lacks."""
    store = _store()
    if type_name not in store.fielddefs:
        raise SetupError(f"unknown ROS 2 type {type_name!r}; {nearest(type_name, store.fielddefs)}")
    made = message_type_from(type_name, store.generate_msgdef(type_name, ros_version=2)[0])
    made.__typehash__ = store.hash_rihs01(type_name)
    return made


@cache
def _store() -> Typestore:
    from rosbags.typesys import Stores, get_typestore  # here: it is an optional package

    # Some standard messages differ between distributions, and with them their type hashes.
    distribution = os.environ.get("ROS_DISTRO", "humble").upper()
    return get_typestore(getattr(Stores, f"ROS2_{distribution}", Stores.ROS2_HUMBLE))
