"""The Python code: what the runtime loads, and what programs import."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.python import conversions, feeds, handlers, interfaces, messages, pb2, registry


def emit(bridge: ir.Bridge) -> Files:
    """Handlers and feeds, message classes, conversions, protobuf's modules, the registry and its checks."""
    for part in (conversions, feeds, handlers, interfaces, messages, pb2, registry):
        yield from part.emit(bridge)
