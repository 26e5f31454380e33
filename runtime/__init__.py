"""What runs on the rover: datagrams to handlers to ROS 2, and back."""

from runtime.bridge import NODE, Bridge
from runtime.errors import (
    ConversionError,
    DatagramError,
    MiddlewareError,
    Reason,
    RegistryError,
    RoverlinkError,
    SetupError,
)
from runtime.handler import Handler, Qos, Route
from runtime.registry import Peer, Registry, load_registry
from runtime.translator import Translator

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
