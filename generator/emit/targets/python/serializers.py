"""Fast serializers: generated subclasses of handlers that make the bytes of a ROS message with one call of `struct`.

They use the values of the payload directly, without an object for the ROS message. CDR, the encoding of ROS messages,
aligns each primitive to its own size (at most 8 bytes), counted from the start of the message. The padding is therefore
known at generation time only if nothing before it has a variable size. A message gets a serializer if everything in it
that varies has a fixed size; strings may only be constants.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from roverlink.generator import ir
from roverlink.generator.emit.extra_topic_names import named_extra_topics
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import interfaces, spelling
from roverlink.generator.emit.targets.python.expressions import attribute, oneof_constant
from roverlink.generator.emit.targets.python.imports import Import, import_lines
from roverlink.generator.emit.targets.python.standard_expressions import StandardSpeller
from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import (
    Chosen,
    Constant,
    Interface,
    Moment,
    Parts,
    Path,
    Rotation,
    Taken,
    TargetField,
    Unset,
)
from roverlink.generator.ir.model import ConversionKind

_MOST_VALUES = 400  # more arguments in one call would be unreadable


@dataclass(frozen=True, slots=True)
class Serializer:
    """Generated module with one serializer class."""

    file: str
    """Name of the module, without a suffix: ``imu_info``."""
    name: str
    """Name of the class: ``FastImuInfoHandler``."""
    text: str


@dataclass(frozen=True, slots=True)
class _Extended:
    """Generated handler class that is the base class of a serializer."""

    route: ir.Route
    name: str
    module: str
    file: str
    """Name of the serializer's module, without a suffix: ``imu_info``."""


@dataclass(frozen=True, slots=True)
class _Constants:
    """Constant parts of a standard message. Generated code serializes them only once, when it is imported."""

    message: str
    """Python expression for a message in which only the constant fields are set."""
    names: list[str]
    """Variables for the constant bytes, in the order of the message: ``_BEFORE_LATITUDE``, ``_END``."""
    varying_paths: list[str]
    """Paths of the fields that vary, with dots: ``header.stamp``."""


@dataclass
class _Body:
    """Arguments of the generated `struct` call, with the assignments and the imports that they need."""

    values: list[str] = field(default_factory=list)
    locals: list[tuple[str, str]] = field(default_factory=list)
    """Assignments before the call: local variables, and the expression that is assigned."""
    imports: set[Import] = field(default_factory=set)


class _VariableSizeError(Exception):
    """Error for a message that cannot have a fast serializer, usually because a part of it has a variable size."""


def serializers(bridge: ir.Bridge) -> dict[str, Serializer]:
    """Return the serializer of each handler that can have one, by the name of the handler's class."""
    by_ros = bridge.conversions()
    found: dict[str, Serializer | None] = {}
    for route in bridge.routes:
        file = spelling.module(route.name)
        handler = _Extended(route, spelling.handler_class(route), f"{bridge.python_package}.handlers.{file}", file)
        if route.conversion:
            found[handler.name] = _of_conversion(bridge, handler, route.conversion, by_ros)
        elif route.standard:
            found[handler.name] = _of_standard(bridge, handler, route.standard)
    rows = {spelling.module(route.name) for route in bridge.routes}
    for extra in named_extra_topics(bridge):
        file = f"{extra.file}_topic"
        while file in rows:
            file += "_"
        module = f"{bridge.python_package}.extra_topics.{extra.file}"
        found[extra.name] = _of_standard(bridge, _Extended(extra.route, extra.name, module, file), extra.standard)
    return {name: serializer for name, serializer in found.items() if serializer}


def emit(bridge: ir.Bridge, fast: Mapping[str, Serializer]) -> Files:
    """Yield the modules of the serializers in ``fast``, and the ``__init__.py`` of their package."""
    for serializer in fast.values():
        yield f"generated/serializers/{serializer.file}.py", serializer.text
    docstring = "Handlers that convert and serialize in one step; the registry loads them."
    yield "generated/serializers/__init__.py", f'{header(bridge.table)}\n"""{docstring}"""\n'


def _serializer(
    bridge: ir.Bridge,
    handler: _Extended,
    source: ir.Conversion | StandardTopic,
    ros: str,
    message: str,
    body: _Body,
    constants: _Constants | None = None,
) -> Serializer:
    own, module = bridge.python_package, spelling.proto_module(source.file)
    imports = {
        *body.imports,
        (handler.module, handler.name),
        (spelling.proto_package(own, source.file), module),
        ("roverlink.runtime.core", "cdr"),
    }
    text = render(
        "serializer.py.j2",
        header=header(f"{bridge.table} (row {handler.route.name}) and {source.file}"),
        imports=import_lines(imports),
        uses_math=constants is not None and any("math." in text for text in (constants.message, *body.values)),
        takes_stamp=any("stamp." in value for value in body.values),
        proto=source.local_name,
        ros=ros,
        handler=handler,
        payload=f"{module}.{source.local_name}",
        message=message,
        constants=constants,
        assignments=body.locals,
        packed_values=body.values,
    )
    return Serializer(handler.file, f"Fast{handler.name}", text)


# --- messages of the package ------------------------------------------------------------------------------------


def _of_conversion(
    bridge: ir.Bridge, handler: _Extended, conversion: ir.Conversion, by_ros: Mapping[str, ir.Conversion]
) -> Serializer | None:
    flattener = _Flattener(conversion, by_ros, handler.module)
    try:
        flattener.add(conversion, "payload", ())
    except _VariableSizeError:
        return None
    body, message = flattener.body, spelling.message_class(conversion.ros)
    body.values.insert(0, "cdr.LITTLE_ENDIAN")
    body.imports.add((f"{bridge.python_package}.messages", message))
    return _serializer(bridge, handler, conversion, f"{bridge.package}/msg/{conversion.ros}", message, body)


class _Flattener:
    """Collector of the expressions for a payload's values, in the order in which CDR serializes the ROS message."""

    def __init__(self, payload: ir.Conversion, by_ros: Mapping[str, ir.Conversion], handler_module: str) -> None:
        self._payload, self._by_ros, self._handler_module = payload, by_ros, handler_module
        self._names: set[str] = {"self", "payload", "l", *spelling.RUNTIME_MODULES}  # l looks like 1
        self._held: dict[str, str] = {}
        self.body = _Body()

    def add(self, conversion: ir.Conversion, holder: str, path: tuple[str, ...]) -> None:
        """Add the expressions for the values of a proto message, which is the payload or a message inside it.

        ``holder`` is the variable with the proto message in generated code. ``path`` leads to it from the payload.
        """
        if not conversion.fields:
            raise _VariableSizeError
        for converted in conversion.fields:
            type = converted.ros.type
            if type.is_sequence or type.name == "string" or len(self.body.values) > _MOST_VALUES:
                raise _VariableSizeError
            owner = holder
            for depth, part in enumerate(converted.proto_path[:-1], start=1):
                owner = self._hold(attribute(owner, part), (*path, *converted.proto_path[:depth]))
            self._add_field(conversion, converted, owner, (*path, *converted.proto_path))

    def _add_field(
        self, conversion: ir.Conversion, converted: ir.FieldConversion, owner: str, path: tuple[str, ...]
    ) -> None:
        name = path[-1]
        value = attribute(owner, name)
        values, imports = self.body.values, self.body.imports
        if converted.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            values.append(f'{owner}.HasField("{name}")')
        elif converted.kind is ConversionKind.MESSAGE:
            nested = self._by_ros.get(converted.converter)
            if nested is None:  # an Any
                raise _VariableSizeError
            self.add(nested, self._hold(value, path), path)
        elif converted.kind is ConversionKind.WHICH:
            if conversion is not self._payload:  # the constants with the members' numbers are in another module
                raise _VariableSizeError
            constant = oneof_constant(converted.ros.name)
            imports |= {("roverlink.runtime.convert", "oneof"), (self._handler_module, constant)}
            values.append(f'oneof.number({owner}, "{name}", {constant})')
        elif converted.kind is ConversionKind.WELL_KNOWN:
            imports.add(("roverlink.runtime.convert.well_known", converted.converter))
            values.append(f'*{converted.converter}.parts({value}, "{converted.ros.name}")')
        else:
            values.append(f"{value}.{converted.wrapping.field}" if converted.wrapping else value)

    def _hold(self, expression: str, path: tuple[str, ...]) -> str:
        """Return the local variable for a nested proto message, so that generated code reads the message only once."""
        if expression in self._held:
            return self._held[expression]
        name = spelling.module("_".join(path))
        while name in self._names:
            name += "_"
        self._names.add(name)
        self._held[expression] = name
        self.body.locals.append((name, expression))
        return name


# --- standard messages ------------------------------------------------------------------------------------------


def _of_standard(bridge: ir.Bridge, handler: _Extended, standard: StandardTopic) -> Serializer | None:
    definitions = {interface.name: interface for interface in bridge.interfaces}
    try:
        leaves = list(_leaves(standard.fields, (), definitions))
    except _VariableSizeError:
        return None
    if not any(varies for _, varies in leaves):
        return None
    speller = StandardSpeller(standard, bridge.python_package)
    gaps = list(_gaps(leaves))
    body = _StandardBody(speller, gaps, definitions)
    body.add(standard.fields)
    body.values += filter(None, gaps[-1:])
    fixed = ", ".join(f"{field.name}={field.value}" for field in speller.arguments(standard.fields, varying=False))
    body.imports |= {
        *speller.imports,
        *((handler.module, name) for name in (*speller.constants, *speller.tables)),
        ("roverlink.runtime.core.standard_handler", "UNSTAMPED"),
        ("roverlink.runtime.interfaces", "Time"),
    }
    message = interfaces.reference(standard.message)
    constants = _Constants(f"{message}({fixed})", [gap for gap in gaps if gap], list(_varying(standard.fields, ())))
    return _serializer(bridge, handler, standard, standard.message, message, body, constants)


def _leaves(
    fields: Iterable[TargetField], path: Path, definitions: Mapping[str, Interface]
) -> Iterator[tuple[Path, bool]]:
    """Yield the path of each leaf of a standard message, and True if its value varies between messages.

    A leaf is a field without parts, or a whole field that is constant. Raises `_VariableSizeError` if a varying leaf
    has no fixed size.
    """
    for target in fields:
        own, value, type = (*path, target.name), target.value, target.type
        if isinstance(value, Parts):
            yield from _leaves(value.fields, own, definitions)
        elif isinstance(value, (Constant, Unset)):
            yield own, False
        elif type.is_message and not type.is_many:
            yield from ((leaf, True) for leaf in _primitives(definitions[type.name], own, definitions))
        elif type.is_sequence or type.name == "string" or type.is_message:
            raise _VariableSizeError
        else:
            yield own, True


def _primitives(interface: Interface, path: Path, definitions: Mapping[str, Interface]) -> Iterator[Path]:
    for defined in interface.fields:
        own = (*path, defined.name)
        if defined.type.is_message:
            yield from _primitives(definitions[defined.type.name], own, definitions)
        else:
            yield own


def _gaps(leaves: Iterable[tuple[Path, bool]]) -> Iterator[str]:
    """Yield the variable for the constant bytes before each varying value, and for those after the last value.

    The names are ``_BEFORE_LATITUDE`` and ``_END``; a name is empty if there are no constant bytes at its place.
    """
    fixed = True  # the message starts with the four bytes of the CDR encapsulation header
    for path, varies in leaves:
        if varies:
            yield f"_BEFORE_{'_'.join(path).upper()}" if fixed else ""
        fixed = not varies
    yield "_END" if fixed else ""


class _StandardBody(_Body):
    """Arguments of the generated `struct` call for a standard message."""

    def __init__(self, speller: StandardSpeller, gaps: list[str], definitions: Mapping[str, Interface]) -> None:
        super().__init__()
        self._speller, self._definitions = speller, definitions
        self._gaps = iter(gaps)

    def add(self, fields: Iterable[TargetField]) -> None:
        """Add the expressions of the varying fields in the order of CDR, each after the constant bytes before it."""
        for target in fields:
            value = target.value
            if isinstance(value, Parts):
                self.add(value.fields)
            elif isinstance(value, Rotation):
                self._unpack(self._speller.rotation(value), ("x", "y", "z", "w"))
            elif isinstance(value, Moment) and value.source is None:
                self._append("stamp.sec", "stamp.nanosec")
            elif isinstance(value, Moment):
                self._unpack(self._speller.moment(value), ("sec", "nanosec"))
            elif isinstance(value, Taken) and value.source.repeated:
                leaves = _leaves([target], (), self._definitions)
                self._append(f"*{self._speller.items(value)}")
                for _ in list(leaves)[1:]:
                    next(self._gaps)
            elif isinstance(value, (Taken, Chosen)):
                self._append(self._speller.value(value))

    def _append(self, *values: str) -> None:
        for value in values:
            self.values += [part for part in (next(self._gaps), value) if part]

    def _unpack(self, call: str, names: Iterable[str]) -> None:
        """Add an assignment of a call's results to local variables, and add the variables as arguments.

        In generated code, this is faster than ``*call()`` among other arguments.
        """
        own = [f"{name}{len(self.locals) or ''}" for name in names]
        self.locals.append((", ".join(own), call))
        self._append(*own)


def _varying(fields: Iterable[TargetField], path: Path) -> Iterator[str]:
    """Yield the dotted path of each field whose value depends on the payload, and is not a constant.

    If all fields of a nested message depend on the payload, the message is yielded as one path.
    """
    for target in fields:
        own = (*path, target.name)
        if _varies(target):
            yield ".".join(own)
        elif isinstance(target.value, Parts):
            yield from _varying(target.value.fields, own)


def _varies(target: TargetField) -> bool:
    """Return True if the value of a field depends on the payload; for a nested message, if every field in it does."""
    if isinstance(target.value, Parts):
        return bool(target.value.fields) and all(_varies(part) for part in target.value.fields)
    return not isinstance(target.value, (Constant, Unset))
