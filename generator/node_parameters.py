"""ROS parameters that the bridge's node has in every project, read from runtime/ros_arguments/node_parameters.yaml.

The file is read as data, because generator and runtime do not import each other. The generator writes the parameters to
config/udp.yaml. The lint reports a peer in mapping.yaml whose port parameter has the name of one of them.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import yaml

from roverlink.bounded_yaml import FAST_LOADER

_DECLARATIONS = Path(__file__).parents[1] / "runtime" / "ros_arguments" / "node_parameters.yaml"


@cache
def node_parameters() -> dict[str, dict[str, Any]]:
    """Return the declaration of each ROS parameter by its name: ``default``, ``description``, ``unit`` and limits."""
    text = _DECLARATIONS.read_text(encoding="utf-8")
    declared: dict[str, dict[str, Any]] = yaml.load(text, FAST_LOADER)  # noqa: S506  # a safe loader
    return declared


def largest_accepted() -> int:
    """Return the size in bytes of the largest datagram that the bridge accepts if no parameter says otherwise."""
    largest: int = node_parameters()["max_datagram"]["default"]
    return largest
