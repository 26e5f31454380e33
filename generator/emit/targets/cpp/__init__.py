"""Target `cpp`, in C++17. It generates a handler class for each topic, and a registry of all handlers.

A handler converts between the class that protobuf generates for a message and the struct that rosidl generates.
"""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import conversions, handlers, library, unsupported_names
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.emit.targets.cpp.cpp_files import FOLDER


def emit(bridge: ir.Bridge) -> Files:
    """Yield the files of the C++ target: handlers, conversions, registry, the runtime library, and the CMake project.

    Raises `DiagnosticsError` for names in the protos that cannot be used in C++.
    """
    unsupported_names.check(bridge)
    context = Context(bridge)
    files = [*conversions.emit(bridge, context), *handlers.emit(bridge, context)]
    yield from files
    yield from library.emit(bridge)
    sources = [path.removeprefix(f"{FOLDER}/") for path, _ in files if path.endswith(".cpp")]
    yield library.cmake(bridge, sources)
