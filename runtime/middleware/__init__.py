"""Middlewares: the connections to ROS 2.

All of them exchange serialized messages, so the bridge can use any of them.
"""

from __future__ import annotations

import importlib
import platform

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.middleware.protocol import (
    Callback,
    Endpoint,
    Middleware,
    NodeIdentity,
    NodeParameters,
    Publisher,
    Subscription,
)

__all__ = [
    "NAMES",
    "Callback",
    "Endpoint",
    "Middleware",
    "NodeIdentity",
    "NodeParameters",
    "Publisher",
    "Subscription",
    "open_middleware",
]

NAMES = ("auto", "dds", "rclpy", "memory")


def open_middleware(name: str, node: NodeIdentity, parameters: NodeParameters | None = None) -> Middleware:
    """Connect to ROS 2 as a node; ``name`` is ``dds``, ``rclpy``, ``memory``, or ``auto``.

    ``auto`` selects rclpy if it can be imported, else dds. ROS 2 tools can read and change ``parameters`` as those of
    the node. Raises `MiddlewareError` if a package is missing; the message says how to install it.
    """
    if name == "auto":
        name = "rclpy" if _imports("rclpy") else "dds"
    # Imports are inside the branches: rclpy and Cyclone DDS are optional and slow to import.
    if name == "memory":
        from roverlink.runtime.middleware.memory import MemoryMiddleware

        return MemoryMiddleware()
    if name == "rclpy":
        return _open_rclpy(node, parameters)
    if name == "dds":
        return _open_dds(node, parameters)
    raise MiddlewareError(f"unknown middleware {name!r} (known: {', '.join(NAMES)})")


def _imports(package: str) -> bool:
    """Return true if a package can be imported.

    To find it is not enough: it may be made for another version of Python.
    """
    try:
        importlib.import_module(package)
    except ImportError:
        return False
    return True


def _open_rclpy(node: NodeIdentity, parameters: NodeParameters | None) -> Middleware:
    try:
        from roverlink.runtime.middleware.rclpy import RclpyMiddleware
    except ImportError as error:
        raise MiddlewareError(
            f"rclpy does not import ({error}); source ROS 2 first (`source /opt/ros/humble/setup.bash`), and make the "
            "environment with --system-site-packages; on x86-64 without ROS 2: pip install 'roverlink[ros]'"
        ) from error
    return RclpyMiddleware(node, parameters)


def _open_dds(node: NodeIdentity, parameters: NodeParameters | None) -> Middleware:
    try:
        from roverlink.runtime.middleware.dds import DdsMiddleware
    except ImportError as error:
        raise MiddlewareError(
            f"Cyclone DDS does not import ({error}); install it with `pip install cyclonedds`"
            + (
                f" (it has no wheel for {platform.machine()}: there, use --middleware rclpy with an installed ROS 2)"
                if platform.machine() not in ("x86_64", "AMD64")
                else ""
            )
        ) from error
    return DdsMiddleware(node, parameters)
