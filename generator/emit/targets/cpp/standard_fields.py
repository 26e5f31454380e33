"""Conversion of a standard message's fields, as ``templates/cpp/standard_message.cpp.j2`` reads it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.emit.arithmetic import Arithmetic, Dialect
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.emit.targets.cpp.literals import literal, text_literal
from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import (
    Chosen,
    Constant,
    InterfaceType,
    Moment,
    Parts,
    Path,
    Rotation,
    Source,
    Taken,
    TargetField,
    Unset,
)

_Leaf = Taken | Chosen | Constant | Rotation | Moment
_CPP = Dialect(separator="'", pi="roverlink::PI", constant="{name}")


@dataclass(frozen=True, slots=True)
class Filled:
    """Field of the standard message that the C++ function ``to_ros`` fills."""

    path: str
    """Path of the field in the standard message: ``header.stamp``."""
    value: str
    """C++ expression for the value. If `source` is set, this is the value of each list item, computed from ``item``."""
    source: str = ""
    """C++ expression of the payload's repeated field whose items fill the list; empty for a single value."""
    count: int = 0
    """Length of a list whose items all have this value; 0 for a single value."""
    is_array: bool = False
    """True if the list has a fixed length (an array), False for a sequence."""


@dataclass(frozen=True, slots=True)
class Recalled:
    """Payload field that the C++ function ``from_ros`` sets, or a variable that holds the angles of a rotation."""

    target: str
    """C++ function that sets the field, ``payload.mutable_inner()->set_x``; or the name of the variable."""
    value: str
    """C++ expression for the value. If `source` is set, this is the value of each list item, computed from ``item``."""
    source: str = ""
    """C++ expression of the list in the ROS message whose items fill the repeated field; empty for a single value."""
    is_rotation: bool = False
    """True if `target` is a variable that holds the angles of a rotation."""


@dataclass(frozen=True, slots=True)
class EnumTable:
    """C++ function that converts between the values of a payload's enum and those of a field in the ROS message."""

    to_number: bool
    """True if the function returns the number of the enum value, false if it returns the value of the ROS field."""
    path: str
    """Path of the field in the ROS message."""
    source: str
    """Path of the payload's enum field."""
    type: str
    """C++ type of the field in the ROS message."""
    cases: tuple[tuple[int, str, str], ...]
    """Number and name of each enum value, and the C++ expression of the field's value in the ROS message."""
    default: str
    """C++ expression for every other enum value; empty if another enum value is an error."""


class StandardFields:
    """Data from which the template writes the C++ functions ``to_ros`` and ``from_ros`` of a standard message."""

    def __init__(self, standard: StandardTopic) -> None:
        self._arithmetic = Arithmetic(_CPP)
        self.refusal = standard.refusal and text_literal(standard.refusal)
        """Reason, as a C++ literal, why ``from_ros`` cannot make a payload; empty if it can."""
        self.headers = {cpp_names.runtime_header("values")}
        self.tables: dict[str, EnumTable] = {}
        """C++ functions that convert enum values, by the functions' names."""
        leaves = [leaf for field in standard.fields for leaf in _leaves(field, ())]
        self.filled = [self._filled(*leaf) for leaf in leaves]
        self.recalled = list(_first_each(self._recalled(standard)))
        self.constants = self._arithmetic.constants
        """C++ expression of each constant that the functions use, by the constant's name."""
        sources = [source for _, value, _ in leaves for source in _sources(value)]
        self.reads_payload = any(sources)
        self.reads_received = None in sources

    # --- to ROS ---

    def _filled(self, path: Path, value: _Leaf, type: InterfaceType) -> Filled:
        dotted = ".".join(path)
        if isinstance(value, Constant) and isinstance(value.value, tuple):
            if len(value.value) > 1 and len(set(value.value)) == 1:
                return Filled(dotted, literal(value.value[0]), count=len(value.value), is_array=type.length is not None)
            return Filled(dotted, f"{{{', '.join(map(literal, value.value))}}}")
        if isinstance(value, Taken) and (value.source.repeated or value.source.type == "bytes"):
            return Filled(dotted, self._made(value, "item", type, path), cpp_names.getter(value.source.path))
        return Filled(dotted, self._value(value, type, path))

    def _value(self, value: _Leaf, type: InterfaceType, path: Path) -> str:
        """Return the C++ expression for a single value of the ROS message; ``path`` leads to its field."""
        if isinstance(value, Constant):
            return self._constant(value)
        if isinstance(value, Taken):
            made = self._made(value, cpp_names.getter(value.source.path), type, path)
            return f"{_has(value.source)} ? {made} : {self._constant(value.default)}" if value.default else made
        if isinstance(value, Chosen):
            return f"{self._table(value, path, type, to_number=False)}({cpp_names.getter(value.source.path)})"
        if isinstance(value, Rotation):
            self.headers.add(cpp_names.runtime_header("rotations"))
            parts = (value.roll, value.pitch, value.yaw)
            angles = ", ".join(self._value(part, InterfaceType("float64"), ()) for part in parts)
            return f"roverlink::quaternion({{{angles}}}, {_shown(path)})"
        return self._moment(value, path)

    def _made(self, value: Taken, text: str, type: InterfaceType, path: Path) -> str:
        """Return the C++ expression for a value of the ROS message.

        ``text`` is the expression for the payload's value.
        """
        source, shown = value.source, _shown(path)
        if source.type == "string":
            bound = f", {type.text_bound}" if type.text_bound else ""
            return f"roverlink::text({text}, {shown}{bound})"
        if source.type in ("bool", "bytes") and source.type != type.name:
            return f"static_cast<{cpp_names.primitive(type.name)}>({text})"
        if value.scaling.is_identity and not source.enum and source.type == type.name:
            return text
        whole = source.is_integer and value.scaling.is_whole
        scaled = self._arithmetic.scaled(_operand(text, source.type), value.scaling, whole=whole)
        if type.name.startswith("float"):
            scaled = f"static_cast<double>({scaled})" if whole else scaled
            scaled = f"std::nearbyint({scaled})" if value.rounded and not whole else scaled
            return f"roverlink::single({scaled}, {shown})" if type.name == "float32" else scaled
        return f"roverlink::{'narrow' if whole else 'rounded'}<{cpp_names.primitive(type.name)}>({scaled}, {shown})"

    def _moment(self, value: Moment, path: Path) -> str:
        if value.source is None:
            return "received"
        whole = value.source.is_integer and value.nanoseconds.denominator == 1
        text = _operand(cpp_names.getter(value.source.path), value.source.type)
        scaled = text if value.nanoseconds == 1 else f"{text} * {_CPP.number(value.nanoseconds, whole=whole)}"
        nanoseconds = scaled if whole else f"roverlink::whole({scaled}, {_shown(path)})"
        return f"roverlink::stamp_of({nanoseconds}, {_shown(path)})"

    # --- from ROS ---

    def _recalled(self, standard: StandardTopic) -> Iterator[Recalled]:
        for index, recovered in enumerate(standard.recovered):
            value, text = recovered.value, ".".join(("message", *recovered.path))
            if isinstance(value, Rotation):
                self.headers.add(cpp_names.runtime_header("rotations"))
                name = f"rotation{index or ''}"
                yield Recalled(name, text, is_rotation=True)
                for angle, part in (("roll", value.roll), ("pitch", value.pitch), ("yaw", value.yaw)):
                    if isinstance(part, Taken):
                        yield Recalled(_setter(part.source), self._untaken(part, f"{name}.{angle}", "float64"))
            elif isinstance(value, Taken) and value.source.repeated:
                item = self._untaken(value, "item", recovered.type.name)
                yield Recalled(_setter(value.source), item, text)
            elif isinstance(value, Taken):
                yield Recalled(_setter(value.source), self._untaken(value, text, recovered.type.name))
            elif isinstance(value, Chosen):
                function = self._table(value, recovered.path, recovered.type, to_number=True)
                yield Recalled(_setter(value.source), _as_declared(value.source, f"{function}({text})"))
            elif value.source:
                number = _unscaled_time(value, value.source, f"roverlink::nanoseconds({text})")
                yield Recalled(_setter(value.source), number)

    def _untaken(self, value: Taken, text: str, type: str) -> str:
        """Return the C++ expression for a value of the payload.

        ``text`` is the expression for the ROS message's value.
        """
        source, scaling = value.source, value.scaling
        shown = _shown(source.path)
        if source.type == "string":
            return f"roverlink::text({text}, {shown})"
        if source.type == "bytes":
            return f"roverlink::bytes({text})"
        if scaling.is_identity and not source.enum and source.type == type:
            return text
        whole = source.is_integer and scaling.is_whole and abs(scaling.factor) == 1 and not type.startswith("float")
        back = self._arithmetic.back(_operand(text, type), scaling, whole=whole)
        if source.is_integer:
            made = f"roverlink::{'narrow' if whole else 'rounded'}<{cpp_names.primitive(source.type)}>({back}, {shown})"
            return _as_declared(source, made)
        return f"roverlink::single({back}, {shown})" if source.type == "float32" else back

    # --- enums ---

    def _table(self, value: Chosen, path: Path, type: InterfaceType, *, to_number: bool) -> str:
        """Return the name of the C++ function that converts an enum's values, and add the function to `tables`."""
        cases = {case.counterpart.value if to_number else case.number: case for case in value.cases}
        table = EnumTable(
            to_number,
            ".".join(path),
            value.source.dotted,
            cpp_names.primitive(type.name),
            tuple((case.number, case.name, self._constant(case.counterpart)) for case in cases.values()),
            self._constant(value.default) if value.default else "",
        )
        target = "_".join(path)
        name = f"{'_'.join(value.source.path)}_from_{target}" if to_number else f"{target}_of"
        while self.tables.setdefault(name, table) != table:
            name += "_"
        return name

    def _constant(self, constant: Constant) -> str:
        """Return the C++ expression for a constant: the name of a ROS constant, or a literal."""
        if not constant.name:
            return literal(constant.value)
        self.headers.add(cpp_names.interface_header(constant.holder))
        return f"{cpp_names.interface_struct(constant.holder)}::{constant.name}"


def _leaves(field: TargetField, holders: Path) -> Iterator[tuple[Path, _Leaf, InterfaceType]]:
    """Yield each field that the table fills, with its path, value and type.

    Nested messages are replaced by their fields.
    """
    path, value = (*holders, field.name), field.value
    if isinstance(value, Parts):
        for part in value.fields:
            yield from _leaves(part, path)
    elif not isinstance(value, Unset):
        yield path, value, field.type


def _sources(value: _Leaf) -> Iterator[Source | None]:
    """Yield the payload's fields from which a value is computed. None stands for the time of reception."""
    for part in (value.roll, value.pitch, value.yaw) if isinstance(value, Rotation) else (value,):
        if isinstance(part, (Taken, Chosen, Moment)):
            yield part.source


def _first_each(recalled: Iterable[Recalled]) -> Iterable[Recalled]:
    """Return the first statement for each field of the payload.

    Two fields of the ROS message may come from the same field of the payload.
    """
    found: dict[str, Recalled] = {}
    for item in recalled:
        found.setdefault(item.target, item)
    return found.values()


def _unscaled_time(value: Moment, source: Source, text: str) -> str:
    type, shown, factor = cpp_names.primitive(source.type), _shown(source.path), value.nanoseconds
    if source.is_integer and factor.denominator == 1:
        whole = text if factor == 1 else f"roverlink::floored({text}, {_CPP.number(factor, whole=True)})"
        return f"roverlink::narrow<{type}>({whole}, {shown})"
    divided = f"static_cast<double>({text})"
    divided += "" if factor == 1 else f" / {_CPP.number(factor, whole=False)}"
    return f"roverlink::rounded<{type}>({divided}, {shown})" if source.is_integer else f"static_cast<{type}>({divided})"


def _operand(text: str, type: str) -> str:
    """Return a C++ expression as the operand of an arithmetic operation.

    Integers are converted to a wide integer type first. Negating a zero as a float would give -0.0.
    """
    return text if type.startswith("float") else f"roverlink::wide({text})"


def _as_declared(source: Source, text: str) -> str:
    return f"roverlink::Enumerator({text}, {_shown(source.path)})" if source.enum else text


def _setter(source: Source) -> str:
    *holders, name = source.path
    holder = "".join(["payload.", *(f"mutable_{cpp_names.accessor(part)}()->" for part in holders)])
    return f"{holder}{'add' if source.repeated else 'set'}_{cpp_names.accessor(name)}"


def _has(source: Source) -> str:
    return f"{cpp_names.getter(source.path[:-1])}.has_{cpp_names.accessor(source.path[-1])}()"


def _shown(path: Path) -> str:
    """Return the name of a field for error messages, as a C++ literal."""
    return f'"{".".join(path)}"'
