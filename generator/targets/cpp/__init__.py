"""C++ 17: a handler class a topic, between protobuf's classes and rosidl's structs, and a registry of them."""

from __future__ import annotations

from generator import ir
from generator.rendering import Files
from generator.targets.cpp import conversions, faults, handlers, library
from generator.targets.cpp.files import FOLDER


def emit(bridge: ir.Bridge) -> Files:
    """Headers and sources of handlers, feeds and conversions, of the registry and the runtime, and CMake's project.

    Raises `DiagnosticsError` for names that protobuf's C++ cannot have.
    """
    faults.check(bridge)
    context = conversions.context_of(bridge)
    files = [*conversions.emit(bridge, context), *handlers.emit(bridge, context), *library.emit(bridge)]
    yield from files
    sources = [path.removeprefix(f"{FOLDER}/") for path, _ in files if path.endswith(".cpp")]
    yield library.cmake(bridge, sources)
