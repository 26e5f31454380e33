"""Files that a project has only once: the registry, a copy of our C++ runtime library, and the CMake project."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render, shipped
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.emit.targets.cpp.cpp_files import FOLDER, CppFile
from roverlink.generator.emit.targets.cpp.handlers import handlers_of

_COPIED = ("CMakeLists.txt", "c/roverlink_signing.[ch]", "cmake/*.cmake", "include/**/*.hpp", "src/*.cpp")


def emit(bridge: ir.Bridge) -> Files:
    """Yield the registry's header, a header for use with rclcpp, and the copy of our C++ runtime library."""
    envelope = cpp_names.proto_class(bridge.envelope.message)
    registry, rclcpp = (CppFile(bridge.package, name, bridge.table) for name in ("registry", "rclcpp"))
    yield from registry.header(
        "registry",
        handlers=handlers_of(bridge),
        envelope=envelope,
        oneof=bridge.envelope.oneof,
        link=bridge.link,
        routes=bridge.routes,
    )
    yield from rclcpp.header("rclcpp")
    # colcon must not build this folder alone: a project adds it to its own build and sets the path of the protos.
    yield f"{FOLDER}/COLCON_IGNORE", header(bridge.table) + "\n"
    yield from _runtime()


def cmake(bridge: ir.Bridge, sources: list[str]) -> tuple[str, str]:
    """Return the path and the text of CMakeLists.txt, which compiles the generated source files and the protos."""
    fields = [field for message in bridge.messages for field in message.fields]
    packages = {field.type.package for field in fields} | {interface.package for interface in bridge.interfaces}
    packages |= {bridge.package} if bridge.messages else set()
    text = render(
        "cpp/CMakeLists.txt.j2",
        header=header(bridge.table),
        package=bridge.package,
        envelope=bridge.envelope.file,
        packages=sorted(packages - {""}),
        protos=sorted(bridge.modules),
        sources=sorted(sources),
    )
    return f"{FOLDER}/CMakeLists.txt", text


def _runtime() -> Files:
    """Yield a copy of our C++ runtime library.

    The generated code gets a copy because roverlink may not be installed on the machine that compiles it.
    """
    library = shipped("cpp")
    for path in sorted(file for pattern in _COPIED for file in library.glob(pattern)):
        name = path.relative_to(library).as_posix()
        mark = header(f"roverlink's cpp/{name}", "//" if path.suffix in (".c", ".h", ".cpp", ".hpp") else "#")
        yield f"{FOLDER}/roverlink/{name}", f"{mark}\n\n{path.read_text(encoding='utf-8')}"
