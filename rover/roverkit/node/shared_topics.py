"""Topics that have the same name in every ROS 2 system."""

from __future__ import annotations

from roverlink.nodes import Direction, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.interfaces.tf2_msgs import TFMessage

_TF = Qos(depth=100)  # the depth of tf2's broadcaster and listener
RECEIVED_TRANSFORMS = Topic("/tf", (TFMessage,), Direction.RECEIVED, "transforms of other nodes", _TF)
STATIC_TRANSFORMS = Topic(
    "/tf_static",
    (TFMessage,),
    Direction.RECEIVED,
    "transforms that do not change, such as mounts of cameras",
    Qos(depth=100, durability="transient_local"),
)
LISTENED_TRANSFORMS = (RECEIVED_TRANSFORMS, STATIC_TRANSFORMS)
"""Topics of a node that looks up transforms."""

DIAGNOSTICS = Topic(
    "/diagnostics",
    (DiagnosticArray,),
    Direction.PUBLISHED,
    "once a second: why results are missing, and how many inputs were left out, by the reason",
    Qos(depth=10),
)


def transforms(meaning: str) -> Topic:
    """Return the topic on which a node publishes transforms."""
    return Topic("/tf", (TFMessage,), Direction.PUBLISHED, meaning, _TF)
