"""The parameters that the node has whatever the table says.

The runtime declares them in a file, which is read here as data: generator and runtime do not import each other.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import yaml

_DECLARATIONS = Path(__file__).parents[1] / "runtime" / "ros_arguments" / "node_parameters.yaml"


@cache
def node_parameters() -> dict[str, dict[str, Any]]:
    """Return what is declared of each parameter, by its name: ``default``, ``description``, ``unit`` and limits."""
    declared: dict[str, dict[str, Any]] = yaml.safe_load(_DECLARATIONS.read_text(encoding="utf-8"))
    return declared
