"""Run-time library of the rover: converts protobuf datagrams to ROS 2 messages, and ROS 2 messages to datagrams."""

if __name__ != "roverlink.runtime":
    raise ImportError("'runtime' is a folder of this repository, not a package; import roverlink.runtime")


from typing import TYPE_CHECKING, Any

from roverlink.runtime.core.errors import (
    ConversionError,
    DatagramError,
    MiddlewareError,
    Reason,
    RegistryError,
    RoverlinkError,
    SetupError,
)
from roverlink.runtime.core.handler import Handler, Qos, Route
from roverlink.runtime.core.registry import Peer, Registry, load_registry
from roverlink.runtime.core.translator import Translator

if TYPE_CHECKING:
    from roverlink.runtime.bridge.bridge import NODE, Bridge

__all__ = [
    "NODE",
    "Bridge",
    "ConversionError",
    "DatagramError",
    "Handler",
    "MiddlewareError",
    "Peer",
    "Qos",
    "Reason",
    "Registry",
    "RegistryError",
    "Route",
    "RoverlinkError",
    "SetupError",
    "Translator",
    "load_registry",
]


def __getattr__(name: str) -> Any:
    """Import `Bridge` and `NODE` when they are first used: most commands need only the core, which imports faster."""
    if name not in ("NODE", "Bridge"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from roverlink.runtime.bridge import bridge

    return getattr(bridge, name)
