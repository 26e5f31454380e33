"""Run-time library of the rover: converts protobuf datagrams to ROS 2 messages, and ROS 2 messages to datagrams."""

if __name__ != "roverlink.runtime":
    raise ImportError("'runtime' is a folder of this repository, not a package; import roverlink.runtime")


from roverlink.runtime.bridge.bridge import NODE, Bridge
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
