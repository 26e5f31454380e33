"""Generated dataclasses for the standard messages that the table needs, and for their nested messages.

There is one module for each ROS 2 package: ``generated/interfaces/sensor_msgs.py``.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from types import MappingProxyType

from roverlink.generator import ir
from roverlink.generator.emit.python_format import literal
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.imports import Import, import_lines
from roverlink.generator.ir.interfaces import Interface, InterfaceConstant, InterfaceField, InterfaceType

_TAKEN = frozenset({"Annotated", "Bound", "Byte", "Char", "Length"})
_TIMES = "builtin_interfaces"
"""Package whose messages `roverlink.runtime.interfaces` exports directly."""
OF_THE_RUNTIME = frozenset(
    {
        *(f"diagnostic_msgs/msg/{name}" for name in ("DiagnosticArray", "DiagnosticStatus", "KeyValue")),
        *(f"geometry_msgs/msg/{name}" for name in ("Point", "Pose", "PoseStamped", "PoseWithCovariance")),
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        *(f"geometry_msgs/msg/{name}" for name in ("Quaternion", "Transform", "TransformStamped", "Vector3")),
        *(f"geometry_msgs/msg/{name}" for name in ("Twist", "TwistStamped", "TwistWithCovariance")),
        *(f"nav_msgs/msg/{name}" for name in ("Odometry", "Path")),
        *(f"sensor_msgs/msg/{name}" for name in ("CameraInfo", "CompressedImage", "Image", "RegionOfInterest")),
        *(f"sensor_msgs/msg/{name}" for name in ("Imu", "NavSatFix", "NavSatStatus")),
        *(f"std_msgs/msg/{name}" for name in ("Header", "String")),
        "tf2_msgs/msg/TFMessage",
    }
)
"""Messages whose classes `roverlink.runtime.interfaces` contains; generated code imports these classes."""
_DEFAULTS = {("geometry_msgs/msg/Quaternion", "w"): "1.0"}
"""Defaults that .msg files declare, by message and field; rosbags leaves them out."""


@dataclass(frozen=True, slots=True)
class _Constant:
    """Class attribute of a generated dataclass, for a constant of the ROS message."""

    name: str
    annotation: str
    value: str


@dataclass(frozen=True, slots=True)
class _Field:
    """Field of a generated dataclass, as source code."""

    name: str
    annotation: str
    default: str


@dataclass(frozen=True, slots=True)
class _Message:
    """Generated dataclass of a ROS message, as the template reads it."""

    ros: str
    """Full name of the ROS message."""
    name: str
    suppression: str
    hash: str
    """Type hash of ROS 2; empty if the class has none."""
    constants: tuple[_Constant, ...]
    fields: tuple[_Field, ...]


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each ROS 2 package, and the ``__init__.py`` of the folder. Yield nothing if none is needed."""
    if not bridge.interfaces:
        return
    for package, interfaces in itertools.groupby(bridge.interfaces, lambda interface: interface.package):
        if package != _TIMES:
            parts = header(bridge.table), package, list(interfaces), bridge.python_package
            yield f"generated/interfaces/{package}.py", module(*parts, imported=OF_THE_RUNTIME)
    docstring = '"""Messages of other ROS 2 packages: one module for each package."""'
    yield "generated/interfaces/__init__.py", f"{header(bridge.table)}\n{docstring}\n"


def reference(name: str, within: str = "") -> str:
    """Return the expression for a ROS message's class in generated code: ``sensor_msgs.Imu`` for sensor_msgs/msg/Imu.

    ``within`` is the ROS package whose module contains the expression. In its own package, the class is only ``Imu``.
    """
    package, _, local = name.partition("/msg/")
    bare = package in (_TIMES, within)
    return local if package == _TIMES else _class(local) if bare else f"{package}.{_class(local)}"


def import_of(name: str, generated: str) -> Import:
    """Return the import that the result of `reference` needs: ``("generated.interfaces", "sensor_msgs")``.

    ``name`` is the full name of the ROS message, ``generated`` the import name of the generated package.
    """
    package, _, local = name.partition("/msg/")
    return ("roverlink.runtime.interfaces", local) if package == _TIMES else (f"{generated}.interfaces", package)


def _class(local: str) -> str:
    # The request of a service is ListParameters_Request.
    return f"{local}_" if local in _TAKEN else spelling.message_class(local.replace("_", ""))


def module(
    top: str,
    package: str,
    interfaces: list[Interface],
    holder: str,
    *,
    imported: Set[str] = frozenset(),
    hashes: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """Return the module with the classes of a ROS 2 package's messages, for ``HOLDER.interfaces``.

    ``top`` is the comment at its top. The classes of ``imported`` come from the runtime. ``hashes`` has the type hashes
    of ROS 2 by the message's full name.
    """
    # A class must be defined before another one uses it as a default factory.
    ours = [interface for interface in _holders_last(interfaces) if interface.name not in imported]
    used = {field.type.name for interface in ours for field in interface.fields if field.type.is_message}
    imports: set[Import] = {
        (f"roverlink.runtime.interfaces.{package}", interface.local_name)
        for interface in interfaces
        if interface.name in imported
    }
    imports |= {found for name in used if (found := import_of(name, holder))[1] != package}
    marks = {name for interface in ours for field in interface.fields for name in _marks(field.type)}
    imports |= {("roverlink.runtime.core.messages", name) for name in (["Message", *marks] if ours else [])}
    messages = [_message(interface, package, hashes.get(interface.name, "")) for interface in ours]
    fields = [field for message in messages for field in message.fields]
    return render(
        "interfaces.py.j2",
        header=top,
        package=package,
        uses_dataclasses=any("dataclasses." in field.default for field in fields),
        typing="Annotated, ClassVar" if any("Annotated[" in field.annotation for field in fields) else "ClassVar",
        imports=import_lines(imports),
        names=sorted(_class(interface.local_name) for interface in interfaces) if imported else [],
        messages=messages,
    )


def _holders_last(interfaces: list[Interface]) -> Iterator[Interface]:
    """Yield the messages in an order in which each message comes after the messages of its fields."""
    by_name = {interface.name: interface for interface in interfaces}
    done: set[str] = set()

    def visit(interface: Interface) -> Iterator[Interface]:
        if interface.name in done:
            return
        done.add(interface.name)
        for field in interface.fields:
            if field.type.name in by_name:
                yield from visit(by_name[field.type.name])
        yield interface

    for interface in interfaces:
        yield from visit(interface)


def _message(interface: Interface, package: str, hash: str) -> _Message:
    name = _class(interface.local_name)
    return _Message(
        ros=interface.name,
        name=name,
        suppression=spelling.class_suppression(name, interface.local_name.replace("_", "")),
        hash=hash,
        constants=tuple(_constant(constant) for constant in interface.constants),
        fields=tuple(_field(field, package, _DEFAULTS.get((interface.name, field.name))) for field in interface.fields),
    )


def _constant(constant: InterfaceConstant) -> _Constant:
    is_integer = "int" in constant.type or constant.type in ("byte", "char")
    return _Constant(constant.name, "int" if is_integer else type(constant.value).__name__, literal(constant.value))


# --- fields -----------------------------------------------------------------------------------------------------


def _marks(type: InterfaceType) -> Iterator[str]:
    """Yield the names that an annotation needs from `roverlink.runtime.core.messages`: ``Float64``, ``Length``."""
    is_bytes = type.is_many and type.name == "uint8"
    if not type.is_message and type.name != "string" and not is_bytes:
        yield spelling.primitive(type.name)
    if type.length is not None:
        yield "Length"
    if type.bound is not None or type.text_bound is not None:
        yield "Bound"


def _annotation(type: InterfaceType, package: str) -> str:
    if type.is_message:
        element = reference(type.name, package)
    elif type.name == "string":
        element = "str" if type.text_bound is None else f"Annotated[str, Bound({type.text_bound})]"
    else:
        element = spelling.primitive(type.name)
    if not type.is_many:
        return element
    container = "bytes" if type.name == "uint8" else f"list[{element}]"
    if type.length is not None:
        return f"Annotated[{container}, Length({type.length})]"
    return container if type.bound is None else f"Annotated[{container}, Bound({type.bound})]"


def _field(field: InterfaceField, package: str, declared: str | None) -> _Field:
    default = declared or _default(field) or f"dataclasses.field(default_factory={_factory(field.type, package)})"
    return _Field(field.name, _annotation(field.type, package), default)


def _default(field: InterfaceField) -> str:
    """Return a field's default as source code; empty if each message needs its own value, such as a new list."""
    type = field.type
    if type.is_many and type.name == "uint8":
        return 'b""' if type.length is None else f"bytes({type.length})"
    if type.is_many or type.is_message:
        return ""
    return spelling.default(ir.RosType(type.name))


def _factory(type: InterfaceType, package: str) -> str:
    element = reference(type.name, package) if type.is_message else ""
    if type.length is None:
        return "list" if type.is_many else element
    if element:
        return f"lambda: [{element}() for _ in range({type.length})]"
    return f"lambda: [{spelling.default(ir.RosType(type.name))}] * {type.length}"
