"""Target `python`: the modules that the runtime loads and that programs import."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.python import (
    conversions,
    extra_topics,
    handlers,
    interfaces,
    messages,
    pb2,
    registry,
    services,
    translations,
)


def emit(bridge: ir.Bridge) -> Files:
    """Yield the modules of the Python target.

    These are handlers, message classes, conversions, protoc's modules, the registry and its checks.
    """
    for part in (conversions, extra_topics, handlers, interfaces, messages, pb2, registry, services, translations):
        yield from part.emit(bridge)
