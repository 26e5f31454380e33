"""Middlewares: the possible connections to ROS 2, which are rclpy, DDS without a ROS installation, and memory.

All middlewares exchange serialized messages (CDR), so the bridge can use any of them.
"""

from __future__ import annotations

import importlib
import platform
import sys

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.middleware import later_modules
from roverlink.runtime.middleware.protocol import (
    NOT_ACCEPTED,
    Callback,
    Endpoint,
    Middleware,
    NodeIdentity,
    NodeParameters,
    Publisher,
    Respond,
    ServiceClient,
    Subscription,
)

__all__ = [
    "NAMES",
    "NOT_ACCEPTED",
    "Callback",
    "Endpoint",
    "Middleware",
    "NodeIdentity",
    "NodeParameters",
    "Publisher",
    "Respond",
    "ServiceClient",
    "Subscription",
    "can_import",
    "dds_cure",
    "open_middleware",
]

NAMES = ("auto", "dds", "rclpy", "memory")


def open_middleware(name: str, node: NodeIdentity, parameters: NodeParameters | None = None) -> Middleware:
    """Connect to ROS 2 as a node; ``name`` is ``dds``, ``rclpy``, ``memory``, or ``auto``.

    ``auto`` selects rclpy if it can be imported, else dds. ``memory`` connects only parts of this process.
    ``parameters`` are the parameters of the node, which ROS 2 tools can then read and change. Raises `MiddlewareError`
    if a package is missing; the message says how to install it.
    """
    if name == "auto":
        name = "rclpy" if can_import("rclpy") else "dds"
    # Imports are inside the branches: rclpy and Cyclone DDS are optional and slow to import.
    if name == "memory":
        from roverlink.runtime.middleware.memory import MemoryMiddleware

        return MemoryMiddleware(parameters=parameters)
    if name == "rclpy":
        return _open_rclpy(node, parameters)
    if name == "dds":
        return _open_dds(node, parameters)
    raise MiddlewareError(f"unknown middleware {name!r} (known: {', '.join(NAMES)})")


def can_import(package: str) -> bool:
    """Return true if a package can be imported.

    The function imports the package, because an installed package may be made for another version of Python.
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
            f"rclpy cannot be imported ({error}); source ROS 2 first (`source /opt/ros/humble/setup.bash`), and make "
            "the virtual environment with --system-site-packages; on x86-64 without ROS 2, install roverlink with the "
            "extra 'ros': `pip install 'SOURCE[ros]'`, where SOURCE is the wheel or the checkout of roverlink"
        ) from error
    return RclpyMiddleware(node, parameters)


def _open_dds(node: NodeIdentity, parameters: NodeParameters | None) -> Middleware:
    try:
        with later_modules.put_off():
            from roverlink.runtime.middleware.dds import DdsMiddleware
    except ImportError as error:
        raise MiddlewareError(f"Cyclone DDS cannot be imported ({error}); {dds_cure()}") from error
    return DdsMiddleware(node, parameters)


def dds_cure() -> str:
    """Return what to do where Cyclone DDS cannot be imported."""
    if sys.version_info >= (3, 14):
        lacking, cure = "Python 3.14 and newer", "make the virtual environment with Python 3.10 to 3.13, or "
    elif platform.machine() not in ("x86_64", "AMD64", "arm64"):  # arm64: macOS
        lacking, cure = platform.machine(), ""
    else:
        return "install it with `pip install cyclonedds`"
    return f"it has no wheel for {lacking}: {cure}use --middleware rclpy with an installed ROS 2"
