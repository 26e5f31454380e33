"""Middlewares: the possible connections to ROS 2: rclpy, DDS or zenoh without a ROS installation, and memory.

All middlewares exchange serialized messages (CDR), so the bridge can use any of them.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import platform
import sys
from collections.abc import Iterator, Sequence
from typing import Any

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
    WatchedSubscription,
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
    "WatchedSubscription",
    "can_import",
    "dds_cure",
    "examine_zenoh",
    "open_middleware",
    "open_zenoh_router",
    "selected",
]

NAMES = ("auto", "dds", "rclpy", "zenoh", "memory")


def open_middleware(name: str, node: NodeIdentity, parameters: NodeParameters | None = None) -> Middleware:
    """Connect to ROS 2 as a node; ``name`` is ``dds``, ``rclpy``, ``zenoh``, ``memory``, or ``auto``.

    ``auto`` selects rclpy if it can be imported, else zenoh if ``RMW_IMPLEMENTATION`` asks for it, else dds. ``memory``
    connects only parts of this process. ``parameters`` are the parameters of the node, which ROS 2 tools can then read
    and change. Raises `MiddlewareError` if a package is missing; the message says how to install it.
    """
    name = selected(name)
    # Imports are inside the branches: rclpy, Cyclone DDS and zenoh are optional and slow to import.
    if name == "memory":
        from roverlink.runtime.middleware.memory import MemoryMiddleware

        return MemoryMiddleware(parameters=parameters)
    if name == "rclpy":
        return _open_rclpy(node, parameters)
    if name == "dds":
        return _open_dds(node, parameters)
    if name == "zenoh":
        with _zenoh_needed():
            from roverlink.runtime.middleware.zenoh import ZenohMiddleware

        return ZenohMiddleware(node, parameters)
    raise MiddlewareError(f"unknown middleware {name!r} (known: {', '.join(NAMES)})")


def selected(name: str) -> str:
    """Return the name of the middleware that ``auto`` selects now; any other name as it is."""
    if name != "auto":
        return name
    if can_import("rclpy"):
        return "rclpy"
    return "zenoh" if os.environ.get("RMW_IMPLEMENTATION") == "rmw_zenoh_cpp" else "dds"


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


def open_zenoh_router(endpoints: Sequence[str]) -> Any:
    """Open a router of zenoh, a context manager, that listens on ``endpoints``; if empty, on the configured ones.

    Raises `MiddlewareError` if zenoh is missing, or if the router cannot listen.
    """
    with _zenoh_needed():
        from roverlink.runtime.middleware.zenoh_config import open_router
    return open_router(endpoints)


def examine_zenoh() -> tuple[str, list[str]]:
    """Join zenoh for a moment; return which router answers, and texts about messages that may not pass.

    Raises `MiddlewareError` if zenoh is missing or refuses its configuration, or if no router answers.
    """
    with _zenoh_needed():
        from roverlink.runtime.middleware.zenoh_config import examine
    return examine()


@contextlib.contextmanager
def _zenoh_needed() -> Iterator[None]:
    """Raise `MiddlewareError` if a module that needs zenoh cannot be imported inside of the context."""
    try:
        yield
    except ImportError as error:
        raise MiddlewareError(
            f"zenoh cannot be imported ({error}); install it with `pip install eclipse-zenoh xxhash`, or install "
            "roverlink with the extra 'zenoh'"
        ) from error


def dds_cure() -> str:
    """Return what to do where Cyclone DDS cannot be imported."""
    if sys.version_info >= (3, 14):
        lacking, cure = "Python 3.14 and newer", "make the virtual environment with Python 3.10 to 3.13, or "
    elif platform.machine() not in ("x86_64", "AMD64", "arm64"):  # arm64: macOS
        lacking, cure = platform.machine(), ""
    else:
        return "install it with `pip install cyclonedds`"
    return f"it has no wheel for {lacking}: {cure}use --middleware rclpy with an installed ROS 2, or --middleware zenoh"
