"""The Python code: what the runtime loads, and what programs import."""

from __future__ import annotations

from generator import ir
from generator.rendering import Files
from generator.targets.python import conversions, handlers, messages, pb2, registry


def emit(bridge: ir.Bridge) -> Files:
    """Handlers, message classes, conversions, protobuf's modules, the registry and its checks."""
    for part in (conversions, handlers, messages, pb2, registry):
        yield from part.emit(bridge)
