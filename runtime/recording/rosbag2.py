"""Metadata of a channel that rosbag2 expects in an MCAP file."""

from __future__ import annotations

from typing import Any

from roverlink.runtime.core.handler import Qos

# The rmw value for an unlimited duration: the largest int64, in nanoseconds.
_FOREVER = {"sec": 9_223_372_036, "nsec": 854_775_807}


def qos_text(qos: Qos) -> str:
    """Return a QoS profile as rosbag2 writes it: a YAML list with one profile, and rmw's enum values as numbers."""
    profile: dict[str, Any] = {
        "history": {"keep_last": 1, "keep_all": 2}[qos.history],
        "depth": qos.depth,
        "reliability": {"reliable": 1, "best_effort": 2}[qos.reliability],
        "durability": {"transient_local": 1, "volatile": 2}[qos.durability],
        "deadline": _FOREVER,
        "lifespan": _FOREVER,
        "liveliness": 1,
        "liveliness_lease_duration": _FOREVER,
        "avoid_ros_namespace_conventions": "false",
    }
    lines = []
    for name, value in profile.items():
        lines.append(f"  {name}:" if isinstance(value, dict) else f"  {name}: {value}")
        if isinstance(value, dict):
            lines += [f"    {part}: {number}" for part, number in value.items()]
    return "\n".join(["-" + lines[0][1:], *lines[1:]])
