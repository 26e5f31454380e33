"""One handler class a row, in a module of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import conversions, layout, spelling
from roverlink.generator.emit.targets.python.bodies import attribute, members_constant
from roverlink.generator.emit.targets.python.conversions import Converters
from roverlink.generator.emit.targets.python.layout import Group
from roverlink.generator.emit.targets.python.routes import route_arguments, runtime_names
from roverlink.generator.ir.model import ConversionKind

_LONGEST_PACK = 400  # values; CPython's call takes any number, a reader does not


def emit(bridge: ir.Bridge) -> Files:
    """The handlers, and the package that names them all."""
    converters = Converters(bridge)
    by_ros = bridge.conversions()
    for route in bridge.routes:
        if route.conversion:
            text = _handler(bridge, route, route.conversion, converters, _pack(route.conversion, by_ros))
            yield f"generated/handlers/{spelling.module(route.name)}.py", text
    names = [(spelling.module(route.name), spelling.handler_class(route)) for route in bridge.routes]
    yield (
        "generated/handlers/__init__.py",
        render(
            "package.py.j2",
            header=header(bridge.table),
            docstring='"""The handlers: one a row of the table."""',
            imports=layout.in_import_order(
                layout.import_from(f"{bridge.python_package}.handlers.{module}", [name]) for module, name in names
            ),
            names=sorted(name for _, name in names),
        ),
    )


def _handler(
    bridge: ir.Bridge, route: ir.Route, conversion: ir.Conversion, converters: Converters, pack: _Pack | None
) -> str:
    imports = [("roverlink.runtime.core.handler", name) for name in ("Handler", *runtime_names(route))]
    imports += [("roverlink.runtime.core", "cdr"), *pack.imports] if pack else []
    view = conversions.view(conversion, converters, 4, extra_imports=imports)
    what = f"{conversion.local_name} {'to' if route.inbound else 'from'} {bridge.package}/msg/{conversion.ros}"
    return render(
        "handler.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {conversion.file}"),
        docstring=layout.docstring(f"{route.name} ({route.number}): {what} on {route.topic}.", 0),
        name=spelling.handler_class(route),
        class_line=layout.statement(
            Group(
                f"class {spelling.handler_class(route)}(",
                [Group("Handler[", [view.payload, view.message], "]")],
                "):",
            )
        ),
        class_docstring=layout.docstring(f"{conversion.local_name} {_arrow(route)} {route.topic}.", 4),
        route=layout.statement(Group("route = Route(", list(route_arguments(route)), ")"), 4),
        conversion=view,
        payload_type=layout.line(f"payload_type = {view.payload}", 4),
        message_type=layout.line(f"message_type = {view.message}", 4),
        pack=pack,
        layout=layout.line(f"_CDR = cdr.fixed_layout({view.message})", 0),
        pack_signature=layout.signature("pack", ["self", f"payload: {view.payload}"], "bytes", 4),
    )


def _arrow(route: ir.Route) -> str:
    return "to the topic" if route.inbound else "from the topic"


# --- the hot path: one struct call for a message of fixed size --------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Pack:
    """The body of ``pack``."""

    locals: tuple[str, ...]
    """Assignments of the nested payloads to names."""
    call: str
    imports: tuple[tuple[str, str], ...]
    """What it needs, by module."""


class _NotFlatError(Exception):
    """The message has a part of variable size, too many parts, or none at all."""


def _pack(conversion: ir.Conversion, by_ros: Mapping[str, ir.Conversion]) -> _Pack | None:
    """None for a message that is no short list of values, which the base class packs."""
    flattener = _Flattener(conversion, by_ros)
    try:
        flattener.add(conversion, "payload", ())
    except _NotFlatError:
        return None
    call = Group("return _CDR.pack(", ["cdr.LITTLE_ENDIAN", *flattener.values], ")")
    return _Pack(tuple(flattener.locals), layout.statement(call, 8), tuple(flattener.imports))


class _Flattener:
    """Collects the values of a payload in the order in which they are serialized."""

    def __init__(self, payload: ir.Conversion, by_ros: Mapping[str, ir.Conversion]) -> None:
        self._payload, self._by_ros = payload, by_ros
        self._names: set[str] = {"self", "payload", "l", *spelling.RUNTIME_MODULES}  # l looks like 1
        self._held: dict[str, str] = {}
        self.locals: list[str] = []
        self.values: list[str | Group] = []
        self.imports: list[tuple[str, str]] = []

    def add(self, conversion: ir.Conversion, holder: str, path: tuple[str, ...]) -> None:
        """Add what a conversion takes from the payload that is called ``holder``."""
        if not conversion.fields:
            raise _NotFlatError
        for field in conversion.fields:
            if field.ros.type.is_sequence or field.ros.type.name == "string" or len(self.values) > _LONGEST_PACK:
                raise _NotFlatError
            owner = holder
            for depth, part in enumerate(field.proto_path[:-1], start=1):
                owner = self._hold(attribute(owner, part), (*path, *field.proto_path[:depth]))
            self._add_field(conversion, field, owner, (*path, *field.proto_path))

    def _add_field(
        self, conversion: ir.Conversion, field: ir.FieldConversion, owner: str, path: tuple[str, ...]
    ) -> None:
        name = path[-1]
        value = attribute(owner, name)
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            self.values.append(Group(f"{owner}.HasField(", [f'"{name}"'], ")"))
        elif field.kind is ConversionKind.MESSAGE:
            nested = self._by_ros.get(field.converter)
            if nested is None:  # an Any
                raise _NotFlatError
            self.add(nested, self._hold(value, path), path)
        elif field.kind is ConversionKind.WHICH:
            if conversion is not self._payload:  # the numbers of its members stand in another module
                raise _NotFlatError
            arguments = [owner, f'"{name}"', members_constant(field.ros.name)]
            self.values.append(Group("oneof.number(", arguments, ")"))
        elif field.kind is ConversionKind.WELL_KNOWN:
            self.imports.append(("roverlink.runtime.convert.well_known", field.converter))
            self.values.append(Group(f"*{field.converter}.parts(", [value, f'"{field.ros.name}"'], ")"))
        else:
            self.values.append(f"{value}.{field.wrapping.field}" if field.wrapping else value)

    def _hold(self, expression: str, path: tuple[str, ...]) -> str:
        """A local name for a nested payload, so that its attribute is looked up once."""
        if expression in self._held:
            return self._held[expression]
        name = spelling.module("_".join(path))
        while name in self._names:
            name += "_"
        self._names.add(name)
        self._held[expression] = name
        self.locals.append(layout.line(f"{name} = {expression}", 8))
        return name
