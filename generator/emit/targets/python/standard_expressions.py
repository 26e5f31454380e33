"""Python expressions that fill a standard message from a payload, and expressions that compute the payload from it."""

from __future__ import annotations

import itertools
import keyword
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from google.protobuf.internal.enum_type_wrapper import EnumTypeWrapper

from roverlink.generator.emit.arithmetic import Arithmetic, Dialect
from roverlink.generator.emit.python_format import literal
from roverlink.generator.emit.targets.python import interfaces, spelling
from roverlink.generator.emit.targets.python.expressions import Argument, mapping
from roverlink.generator.emit.targets.python.imports import Import
from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import (
    Chosen,
    Constant,
    InterfaceType,
    Moment,
    Parts,
    Path,
    Recovered,
    Rotation,
    Scalar,
    Source,
    SourceEnum,
    Taken,
    TargetField,
    Unset,
)

_NANOSECONDS = 1_000_000_000  # in a second
_PYTHON = Dialect(separator="_", pi="math.pi", constant="{name}")


@dataclass(frozen=True, slots=True)
class TableCase:
    """Entry of a `Table`: an enum value, ``key``, and the value of the standard message that stands for it.

    Both values are Python expressions.
    """

    key: str
    counterpart: str
    comment: str
    """Name of the enum value if ``key`` is only its number; else empty."""


@dataclass(frozen=True, slots=True)
class Table:
    """Generated dict from the values of a payload's enum to values of the standard message."""

    name: str
    """Name of the dict in generated code: ``FIX_QUALITY``."""
    field: str
    """Name of the payload's field in error messages."""
    cases: tuple[TableCase, ...]


@dataclass(frozen=True, slots=True)
class InverseTable:
    """Generated dict from values of the standard message to values of a payload's enum: the inverse of a `Table`."""

    name: str
    of: str
    """Name of the dict that is inverted: ``FIX_QUALITY``."""
    field: str
    """Name of the standard message's field in error messages."""


class StandardSpeller:
    """Writer of the Python expressions for one standard message. It collects the constants, enum tables and imports."""

    def __init__(self, standard: StandardTopic, generated: str) -> None:
        self._standard, self._generated = standard, generated
        self._arithmetic = Arithmetic(_PYTHON)
        self.tables: dict[str, Table] = {}
        self.inverse_tables: dict[str, InverseTable] = {}
        self.imports: set[Import] = {interfaces.import_of(standard.message, generated)}
        self.table_imports: set[Import] = set()
        self._enum_modules = {spelling.proto_module(standard.file): standard.file}
        """.proto file of each imported protobuf module, by the module's name: ``imu_pb2``."""
        self.takes_stamp = False
        """True if a field of the message is filled with the time at which the datagram was received."""

    @property
    def constants(self) -> Mapping[str, str]:
        """Expressions of the factors that contain π, by constant name: ``DEG_TO_RAD`` is ``math.pi / 180``."""
        return self._arithmetic.constants

    # --- to ROS ---

    def arguments(self, fields: Iterable[TargetField], *, varying: bool = True) -> tuple[Argument, ...]:
        """Return the keyword arguments that construct a message with these fields.

        If ``varying`` is false, return only the arguments that are the same in every message.
        """
        found = ((field.name, self._argument(field, varying)) for field in fields)
        return tuple(Argument(name, value) for name, value in found if value)

    def _argument(self, field: TargetField, varying: bool) -> str:
        """Return the expression for a field's value; empty if `arguments` leaves the field out."""
        value = field.value
        if isinstance(value, Parts):
            parts = self.arguments(value.fields, varying=varying)
            inside = ", ".join(f"{part.name}={part.value}" for part in parts)
            return self._made(field.type.name, inside) if inside or varying else ""
        if isinstance(value, Constant):
            if isinstance(value.value, tuple):
                return _list(value.value, field.type)
            return self._constant(value, self.imports)
        if isinstance(value, Unset) or not varying:
            return ""
        if isinstance(value, Rotation):
            return self._made(field.type.name, f"*{self.rotation(value)}")
        if isinstance(value, Moment):
            return self._receipt() if value.source is None else self._made(field.type.name, f"*{self.moment(value)}")
        return self.value(value)

    def _receipt(self) -> str:
        self.takes_stamp = True
        return "stamp"

    def _made(self, message: str, arguments: str) -> str:
        self.imports.add(interfaces.import_of(message, self._generated))
        return f"{interfaces.reference(message)}({arguments})"

    def value(self, value: Taken | Chosen) -> str:
        """Return the expression for a value that comes from one payload field: ``payload.gyro_x * DEG_TO_RAD``."""
        if isinstance(value, Chosen):
            return self._chosen(value)
        if value.source.repeated:
            items = self.items(value)
            return items if items.startswith("[") else f"list({items})"
        taken = self._scaled(value, _payload(value.source))
        if value.default is None:
            return taken
        *holders, name = value.source.path
        default = self._constant(value.default, self.imports)
        return f'{taken} if {".".join(("payload", *holders))}.HasField("{name}") else {default}'

    def items(self, value: Taken) -> str:
        """Return the expression for an iterable over the converted items of a repeated field."""
        source, item = _payload(value.source), self._scaled(value, "item")
        return source if item == "item" else f"[{item} for item in {source}]"

    def _scaled(self, value: Taken, text: str) -> str:
        whole = value.source.is_integer and value.scaling.is_whole
        scaled = self._arithmetic.scaled(text, value.scaling, whole=whole)
        return f"round({scaled})" if value.rounded else scaled

    def _chosen(self, value: Chosen) -> str:
        name = self._table(value)
        if value.default is None:
            return f"{name}[{_payload(value.source)}]"
        default = self._constant(value.default, self.imports)
        return f"{name}.get({_payload(value.source)}, {default})"

    def _table(self, value: Chosen) -> str:
        """Return the name of the generated dict for an enum field, ``FIX_QUALITY``. Add the dict to `tables`."""
        self.table_imports.add(("roverlink.runtime.core.standard_handler", "Counterparts"))
        cases = tuple(self._cases(value))
        name = "_".join(value.source.path).upper()
        while (table := Table(name, value.source.dotted, cases)) != self.tables.setdefault(name, table):
            name += "_"
        return name

    def _cases(self, value: Chosen) -> Iterator[TableCase]:
        enum = self._enum(value.source.enum) if value.source.enum else ""
        for case in value.cases:
            counterpart = self._constant(case.counterpart, self.table_imports)
            if enum and _is_attribute(case.name):
                yield TableCase(f"{enum}.{case.name}", counterpart, "")
            else:
                yield TableCase(str(case.number), counterpart, case.name)

    def _enum(self, enum: SourceEnum) -> str:
        """Return the expression for an enum's class: ``gps_pb2.FixQuality``. Add the import of its module.

        Return an empty text if a part of the class's name is a Python keyword, or if the module has the same name as
        the module of another .proto file.
        """
        module = spelling.proto_module(enum.file)
        is_usable = not any(map(keyword.iskeyword, enum.local_name.split(".")))
        if not is_usable or self._enum_modules.setdefault(module, enum.file) != enum.file:
            return ""
        self.table_imports.add((spelling.proto_package(self._generated, enum.file), module))
        return f"{module}.{enum.local_name}"

    def _constant(self, constant: Constant, imports: set[Import]) -> str:
        """Return the expression for a constant: the name of a ROS constant, whose import is added, or a literal."""
        if not constant.name:
            return _literal(constant.value)
        imports.add(interfaces.import_of(constant.holder, self._generated))
        return f"{interfaces.reference(constant.holder)}.{constant.name}"

    def rotation(self, value: Rotation) -> str:
        """Return the call that computes a quaternion from roll, pitch and yaw. The call returns x, y, z and w."""
        self.imports.add(("roverlink.runtime.convert", "rotations"))
        parts = (value.roll, value.pitch, value.yaw)
        angles = [_literal(part.value) if isinstance(part, Constant) else self.value(part) for part in parts]
        return f"rotations.quaternion({', '.join(angles)})"

    def moment(self, value: Moment) -> str:
        """Return the expression that converts a payload field to a time: a pair of seconds and nanoseconds."""
        source = value.source
        text = _payload(source) if source else ""
        whole = source is not None and source.is_integer and value.nanoseconds.denominator == 1
        scaled = text if value.nanoseconds == 1 else f"{text} * {_PYTHON.number(value.nanoseconds, whole=whole)}"
        return f"divmod({scaled if whole else f'round({scaled})'}, {_NANOSECONDS:_})"

    # --- from ROS ---

    def angles(self) -> Iterator[tuple[str, str]]:
        """Yield the first assignments in ``from_ros``, which compute angles from quaternions: variables and expression.

        An assignment is ``("roll, pitch, yaw", "rotations.angles(message.orientation)")``.
        """
        for index, recovered in enumerate(self._standard.recovered):
            if isinstance(recovered.value, Rotation):
                self.imports.add(("roverlink.runtime.convert", "rotations"))
                names = [name if isinstance(part, Taken) else f"_{name}" for part, name in _angles(recovered, index)]
                yield ", ".join(names), f"rotations.angles({_message(recovered.path)})"

    def recovered(self) -> tuple[Argument, ...]:
        """Return the arguments with which ``from_ros`` constructs the payload."""
        found: dict[Path, str] = {}
        for index, recovered in enumerate(self._standard.recovered):
            for source, value in self._recovered(recovered, index):
                found.setdefault(source.path, value)
        return tuple(Argument(*entry) for entry in _nested(sorted(found.items(), key=lambda pair: pair[0][:-1]), 0))

    def _recovered(self, recovered: Recovered, index: int) -> Iterator[tuple[Source, str]]:
        value, text = recovered.value, _message(recovered.path)
        if isinstance(value, Rotation):
            for part, name in _angles(recovered, index):
                if isinstance(part, Taken):
                    yield part.source, self._unscaled(part, name, "float64")
        elif isinstance(value, Taken):
            yield value.source, self._unscaled(value, text, recovered.type.name)
        elif isinstance(value, Chosen):
            table = self._table(value)
            inverse = InverseTable(f"{table}_BACK", table, ".".join(recovered.path))
            self.inverse_tables[inverse.name] = inverse
            yield value.source, f"{inverse.name}[{text}]"
        elif value.source:
            self.imports.add(("roverlink.runtime.core.standard_handler", "nanoseconds"))
            yield value.source, _unscaled_time(value.source, value.nanoseconds, f"nanoseconds({text})")

    def _unscaled(self, value: Taken, text: str, type: str) -> str:
        source, scaling = value.source, value.scaling
        item = "item" if source.repeated else text
        whole = source.is_integer and scaling.is_whole and abs(scaling.factor) == 1 and not type.startswith("float")
        back = self._arithmetic.back(item, scaling, whole=whole)
        if source.is_integer and not whole:
            back = f"round({back})"
        elif source.type == "float32" and (type == "float64" or not scaling.is_identity):
            self.imports.add(("roverlink.runtime.core.standard_handler", "single"))
            back = f"single({back})"
        if not source.repeated:
            return back
        return text if back == "item" else f"[{back} for item in {text}]"


def _angles(recovered: Recovered, index: int) -> Iterator[tuple[Taken | Constant, str]]:
    """Yield the angles of a rotation with the names of their variables. ``index`` makes the names unique: ``roll2``."""
    rotation = recovered.value
    if isinstance(rotation, Rotation):
        parts = (rotation.roll, rotation.pitch, rotation.yaw)
        yield from zip(parts, (f"{angle}{index or ''}" for angle in ("roll", "pitch", "yaw")))


def _nested(found: list[tuple[Path, str]], depth: int) -> Iterator[tuple[str, str]]:
    """Yield the name and the expression of each payload field at ``depth`` of the paths in ``found``.

    The fields of a nested message become one dict: ``{"x": message.position.x}``.
    """
    for name, group in itertools.groupby(found, lambda pair: pair[0][depth]):
        members = list(group)
        if len(members[0][0]) == depth + 1:
            yield name, members[0][1]
        else:
            yield name, mapping(_nested(members, depth + 1))


def _unscaled_time(source: Source, nanoseconds: Fraction, text: str) -> str:
    if nanoseconds == 1:
        return text
    if not source.is_integer:
        return f"{text} / {_PYTHON.number(nanoseconds, whole=False)}"
    if nanoseconds.denominator == 1:
        return f"{text} // {_PYTHON.number(nanoseconds, whole=True)}"
    return f"round({text} / {_PYTHON.number(nanoseconds, whole=False)})"


def _payload(source: Source) -> str:
    return ".".join(("payload", *source.path))


def _message(path: Path) -> str:
    return ".".join(("message", *path))


def _list(values: tuple[Scalar, ...], type: InterfaceType) -> str:
    if type.name == "uint8":
        return f"bytes([{', '.join(map(str, values))}])" if any(values) else f"bytes({len(values)})"
    if len(set(values)) == 1 and len(values) > 1:
        return f"[{_literal(values[0])}] * {len(values)}"
    return f"[{', '.join(map(_literal, values))}]"


def _is_attribute(name: str) -> bool:
    """Return True if Python can read the enum value ``name`` as an attribute of the enum's class: ``Fix.NONE``."""
    return not keyword.iskeyword(name) and name not in dir(EnumTypeWrapper)


def _literal(value: object) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return "math.nan" if math.isnan(value) else ("math.inf" if value > 0 else "-math.inf")
    return literal(value)
