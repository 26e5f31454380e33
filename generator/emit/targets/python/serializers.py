"""Fast serializers: subclasses of handlers that serialize a payload with one call of `struct`.

CDR aligns each primitive to its own size (at most 8 bytes), counted from the start of the message. The padding is
therefore known at generation time only if nothing before it has a variable size. A message gets a serializer if
everything in it that varies has a fixed size; strings may only be constants.
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
    """Module of a serializer."""

    file: str
    name: str
    """Name of the class."""
    text: str


@dataclass
class _Body:
    """Arguments of the `struct` call, and the module's needs for them."""

    values: list[str] = field(default_factory=list)
    locals: list[tuple[str, str]] = field(default_factory=list)
    """Assignments before the call."""
    imports: set[Import] = field(default_factory=set)


class _VariableSizeError(Exception):
    """Error for a message that has a part of variable size, too many parts, or none."""


def serializers(bridge: ir.Bridge) -> dict[str, Serializer]:
    """Return the serializers by the names of the handlers' classes."""
    by_ros = bridge.conversions()
    found: dict[str, Serializer | None] = {}
    for route in bridge.routes:
        handler, file = spelling.handler_class(route), spelling.module(route.name)
        if route.conversion:
            found[handler] = _of_conversion(bridge, route, route.conversion, by_ros)
        elif route.standard:
            found[handler] = _of_standard(bridge, route, route.standard, handler, f"handlers.{file}", file)
    rows = {spelling.module(route.name) for route in bridge.routes}
    for extra in named_extra_topics(bridge):
        file = f"{extra.file}_topic"
        while file in rows:
            file += "_"
        found[extra.name] = _of_standard(
            bridge, extra.route, extra.standard, extra.name, f"extra_topics.{extra.file}", file
        )
    return {name: serializer for name, serializer in found.items() if serializer}


def emit(bridge: ir.Bridge, fast: Mapping[str, Serializer]) -> Files:
    """Yield the serializers, and their package."""
    for serializer in fast.values():
        yield f"generated/serializers/{serializer.file}.py", serializer.text
    docstring = "Handlers that convert and serialize in one step; the registry loads them."
    yield "generated/serializers/__init__.py", f'{header(bridge.table)}\n"""{docstring}"""\n'


# --- messages of the package ------------------------------------------------------------------------------------


def _of_conversion(
    bridge: ir.Bridge, route: ir.Route, conversion: ir.Conversion, by_ros: Mapping[str, ir.Conversion]
) -> Serializer | None:
    own, file = bridge.python_package, spelling.module(route.name)
    flattener = _Flattener(conversion, by_ros, f"{own}.handlers.{file}")
    try:
        flattener.add(conversion, "payload", ())
    except _VariableSizeError:
        return None
    body = flattener.body
    handler, message = spelling.handler_class(route), spelling.message_class(conversion.ros)
    module = spelling.proto_module(conversion.file)
    body.values.insert(0, "cdr.LITTLE_ENDIAN")
    body.imports |= {
        (f"{own}.handlers.{file}", handler),
        (f"{own}.messages", message),
        (spelling.proto_package(own, conversion.file), module),
        ("roverlink.runtime.core", "cdr"),
    }
    text = render(
        "serializer.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {conversion.file}"),
        imports=import_lines(body.imports),
        uses_math=False,
        proto=conversion.local_name,
        ros=f"{bridge.package}/msg/{conversion.ros}",
        handler=handler,
        payload=f"{module}.{conversion.local_name}",
        message=message,
        handler_module=f"{own}.handlers.{file}",
        constant_message="",
        assignments=body.locals,
        packed_values=body.values,
    )
    return Serializer(file, f"Fast{handler}", text)


class _Flattener:
    """Collector of a payload's values in the order of serialization."""

    def __init__(self, payload: ir.Conversion, by_ros: Mapping[str, ir.Conversion], handler_module: str) -> None:
        self._payload, self._by_ros, self._handler_module = payload, by_ros, handler_module
        self._names: set[str] = {"self", "payload", "l", *spelling.RUNTIME_MODULES}  # l looks like 1
        self._held: dict[str, str] = {}
        self.body = _Body()

    def add(self, conversion: ir.Conversion, holder: str, path: tuple[str, ...]) -> None:
        """Add the values that a conversion takes from the payload in the variable ``holder``."""
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
        """Return a local variable for a nested payload, so that its attribute is looked up only once."""
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


def _of_standard(
    bridge: ir.Bridge, route: ir.Route, standard: StandardTopic, handler: str, module: str, file: str
) -> Serializer | None:
    own = bridge.python_package
    definitions = {interface.name: interface for interface in bridge.interfaces}
    try:
        leaves = list(_leaves(standard.fields, (), definitions))
    except _VariableSizeError:
        return None
    if not any(varies for _, varies in leaves):
        return None
    speller = StandardSpeller(standard, own)
    gaps = list(_gaps(leaves))
    body = _StandardBody(speller, gaps, definitions)
    body.add(standard.fields)
    values = [*body.values, *gaps[-1:]] if gaps[-1] else body.values
    fixed = ", ".join(f"{field.name}={field.value}" for field in speller.arguments(standard.fields, varying=False))
    takes_stamp = any("stamp." in value for value in values)
    proto_module = spelling.proto_module(standard.file)
    shared = {*speller.constants, *speller.tables}
    imports = {
        *speller.imports,
        *((f"{own}.{module}", name) for name in (handler, *shared)),
        (spelling.proto_package(own, standard.file), proto_module),
        ("roverlink.runtime.core", "cdr"),
        ("roverlink.runtime.core.standard_handler", "UNSTAMPED"),
        ("roverlink.runtime.interfaces", "Time"),
    }
    constant_message = f"{interfaces.reference(standard.message)}({fixed})"
    text = render(
        "serializer.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {standard.file}"),
        imports=import_lines(imports),
        uses_math=any("math." in text for text in (constant_message, *values)),
        proto=standard.local_name,
        ros=standard.message,
        handler=handler,
        payload=f"{proto_module}.{standard.local_name}",
        message=interfaces.reference(standard.message),
        takes_stamp=takes_stamp,
        handler_module=f"{own}.{module}",
        constant_message=constant_message,
        varying_paths=list(_varying(standard.fields, ())),
        constant_names=[gap for gap in gaps if gap],
        assignments=body.locals,
        packed_values=values,
    )
    return Serializer(file, f"Fast{handler}", text)


def _leaves(
    fields: Iterable[TargetField], path: Path, definitions: Mapping[str, Interface]
) -> Iterator[tuple[Path, bool]]:
    """Yield the path of each primitive of a message; the flag is True if its value varies.

    Raises `_VariableSizeError` if a varying part has no fixed size.
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
    """Yield the name of the constant bytes before each varying value and at the end; empty if there are none."""
    fixed = True  # the message starts with the four bytes of the CDR encapsulation header
    for path, varies in leaves:
        if varies:
            yield f"_BEFORE_{'_'.join(path).upper()}" if fixed else ""
        fixed = not varies
    yield "_END" if fixed else ""


class _StandardBody(_Body):
    """Arguments of the `struct` call for a standard message."""

    def __init__(self, speller: StandardSpeller, gaps: list[str], definitions: Mapping[str, Interface]) -> None:
        super().__init__()
        self._speller, self._definitions = speller, definitions
        self._gaps = iter(gaps)

    def add(self, fields: Iterable[TargetField]) -> None:
        """Add the values of fields in the order of CDR, each after the constant bytes before it."""
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
        """Assign the results of a call to variables, which is faster than ``*call()`` among other arguments."""
        own = [f"{name}{len(self.locals) or ''}" for name in names]
        self.locals.append((", ".join(own), call))
        self._append(*own)


def _varying(fields: Iterable[TargetField], path: Path) -> Iterator[str]:
    """Yield the paths of varying parts; a message that varies completely is one path."""
    for target in fields:
        own = (*path, target.name)
        if _varies(target):
            yield ".".join(own)
        elif isinstance(target.value, Parts):
            yield from _varying(target.value.fields, own)


def _varies(target: TargetField) -> bool:
    """Return True if every part of a field varies."""
    if isinstance(target.value, Parts):
        return bool(target.value.fields) and all(_varies(part) for part in target.value.fields)
    return not isinstance(target.value, (Constant, Unset))
