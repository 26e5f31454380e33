"""C++17 target: one handler class for each topic, between protobuf's classes and rosidl's structs, and a registry."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import conversions, handlers, library, unsupported_names
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.emit.targets.cpp.cpp_files import FOLDER


def emit(bridge: ir.Bridge) -> Files:
    """Yield handlers, extra topics, conversions and registry, a copy of the runtime library, and the CMake project.

    Raises `DiagnosticsError` for names that protobuf's C++ cannot have.
    """
    unsupported_names.check(bridge)
    context = Context(bridge)
    files = [*conversions.emit(bridge, context), *handlers.emit(bridge, context)]
    yield from files
    yield from library.emit(bridge)
    sources = [path.removeprefix(f"{FOLDER}/") for path, _ in files if path.endswith(".cpp")]
    yield library.cmake(bridge, sources)
