"""What is there once: the registry, the runtime that the handlers share, and what builds the library."""

from __future__ import annotations

from generator import ir
from generator.ir import ConversionKind
from generator.ir_standard import Parts, Rotation, TargetField
from generator.rendering import Files, header, render
from generator.targets.cpp import layout, names
from generator.targets.cpp.files import FOLDER, Pair, header_file, pair
from generator.targets.cpp.handlers import Handler, handlers_of
from generator.well_known import FIELD_MASK

_HEADERS_ALONE = frozenset({"errors", "handler", "feeds"})


def emit(bridge: ir.Bridge) -> Files:
    """The runtime, as far as the handlers need it, the registry, and a project of CMake."""
    view = {
        "envelope": names.proto_class(bridge.envelope.message),
        "envelope_header": names.proto_header(bridge.envelope.file),
        "oneof": bridge.envelope.oneof,
    }
    for part in _runtime_parts(bridge):
        files = Pair(bridge.package, f"runtime/{part}", bridge.table)
        if part in _HEADERS_ALONE:
            yield header_file(files, f"runtime/{part}", **view)
        else:
            yield from pair(files, f"runtime/{part}", **view)
    handlers = handlers_of(bridge)
    yield header_file(
        Pair(bridge.package, "registry", bridge.table),
        "registry",
        headers=layout.includes(
            [f"{bridge.package}/{file}.hpp" for file in ("runtime/registry", *(one.file for one in handlers))]
        ),
        inbound=_classes([one for one in handlers if one.route.inbound]),
        outbound=_classes([one for one in handlers if not one.route.inbound]),
    )
    yield header_file(Pair(bridge.package, "rclcpp", bridge.table), "rclcpp")
    # No package of its own: it is for the projects that add it, which say where the protos are.
    yield f"{FOLDER}/COLCON_IGNORE", header(bridge.table) + "\n"


def cmake(bridge: ir.Bridge, sources: list[str]) -> tuple[str, str]:
    """The project of CMake, which compiles sources and protos."""
    fields = [field for message in bridge.messages for field in message.fields]
    packages = {field.type.package for field in fields} | {interface.package for interface in bridge.interfaces}
    packages |= {"builtin_interfaces"} if "well_known" in _runtime_parts(bridge) else set()
    packages |= {bridge.package} if bridge.messages else set()
    text = render(
        "cpp/CMakeLists.txt.j2",
        header=header(bridge.table),
        package=bridge.package,
        envelope=bridge.envelope.file,
        packages=sorted(packages - {""}),
        protos=sorted({f"{path.rpartition('_pb2')[0]}.proto" for path in bridge.modules}),
        sources=sorted(sources),
    )
    return f"{FOLDER}/CMakeLists.txt", text


def _classes(handlers: list[Handler]) -> str:
    return ",".join(f"\n  {one.name}" for one in handlers)


def _runtime_parts(bridge: ir.Bridge) -> list[str]:
    """The names of the runtime's files."""
    fields = [field for conversion in bridge.conversions().values() for field in conversion.fields]
    fields += [field.entry.value for field in fields if field.entry]
    kinds = {field.kind for field in fields}
    masks = any(field.wrapping and field.wrapping.proto == FIELD_MASK for field in fields)
    feeds = [feed for route in bridge.routes for feed in route.feeds]
    parts = ["errors", "handler", "registry", "values"]
    parts += ["json", "json_reader"] if ConversionKind.JSON in kinds else []
    parts += ["well_known"] if ConversionKind.WELL_KNOWN in kinds or masks else []
    parts += ["any_of"] if bridge.anys else []
    parts += ["feeds"] if feeds else []
    parts += ["rotations"] if any(_rotates(field) for feed in feeds for field in feed.fields) else []
    return parts


def _rotates(field: TargetField) -> bool:
    """Whether there is a rotation among what fills a field."""
    if isinstance(field.value, Parts):
        return any(map(_rotates, field.value.fields))
    return isinstance(field.value, Rotation)
