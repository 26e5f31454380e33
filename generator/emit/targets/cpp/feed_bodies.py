"""The bodies of ``to_ros`` and ``from_ros`` of one feed: what fills a standard message, and what it tells."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.emit.arithmetic import Arithmetic, Dialect
from roverlink.generator.emit.targets.cpp import cpp_names, layout
from roverlink.generator.emit.targets.cpp.counterparts import Counterparts
from roverlink.generator.emit.targets.cpp.layout import literal
from roverlink.generator.ir import Feed
from roverlink.generator.ir.interfaces import (
    Chosen,
    Constant,
    InterfaceType,
    Moment,
    Parts,
    Path,
    Recovered,
    Rotation,
    Source,
    Taken,
    TargetField,
    Value,
)

_CPP = Dialect(separator="'", pi="roverlink::PI", power="std::pow({base}, {exponent})", constant="{name}")


class FeedBodies:
    """Spells one feed."""

    def __init__(self, feed: Feed) -> None:
        self._feed = feed
        self._arithmetic = Arithmetic(_CPP)
        self._counterparts = Counterparts()
        self.headers = {cpp_names.runtime_header("values")}
        """What the bodies need, as far as they were spelled."""

    def constants(self) -> Iterator[str]:
        """The lines that stand above the class, of what the bodies use."""
        yield from (f"const double {name} = {value};" for name, value in self._arithmetic.constants.items())

    def functions(self) -> Iterator[str]:
        """The functions that stand above the class: one a table of an enum's values."""
        self.headers |= self._counterparts.headers
        yield from self._counterparts.functions()

    # --- to ROS ---

    def to_ros(self) -> Iterator[str]:
        """The statements of ``to_ros``, which make ``message`` from ``payload``."""
        message = cpp_names.interface_struct(self._feed.message)
        yield f"{message} message;"
        for field in self._feed.fields:
            yield from self._filled(field, (field.name,))
        yield "return message;"

    def _filled(self, field: TargetField, path: Path) -> Iterator[str]:
        """The statements that fill a field of the message; none for one that stays as it is in a new message."""
        target, value = ".".join(("message", *path)), field.value
        if isinstance(value, Parts):
            for part in value.fields:
                yield from self._filled(part, (*path, part.name))
        elif isinstance(value, Constant):
            yield _constant(target, value.value, field.type)
        elif isinstance(value, Rotation):
            self.headers.add(cpp_names.runtime_header("rotations"))
            angles = ", ".join(self._angle(part) for part in (value.roll, value.pitch, value.yaw))
            yield f"{target} = roverlink::quaternion({{{angles}}}, {_shown(path)});"
        elif isinstance(value, Moment):
            yield f"{target} = {self._moment(value, path)};"
        elif isinstance(value, Chosen):
            function = self._counterparts.there(value, path, field.type)
            yield f"{target} = {function}({cpp_names.getter(value.source.path)});"
        elif isinstance(value, Taken):
            yield from self._taken(target, value, field.type, path)

    def _taken(self, target: str, value: Taken, type: InterfaceType, path: Path) -> Iterator[str]:
        source = cpp_names.getter(value.source.path)
        if value.source.type == "bytes":
            make = "[](char byte) {return static_cast<std::uint8_t>(byte);}"
            yield f"roverlink::fill({target}, {source}, {_shown(path)}, {make});"
        elif value.source.repeated:
            made = self._made(value, "item", type, path)
            yield f"roverlink::fill({target}, {source}, {_shown(path)}, [](auto item) {{return {made};}});"
        elif value.default is None:
            yield f"{target} = {self._made(value, source, type, path)};"
        else:
            yield f"{target} = {literal(value.default)};"
            yield from layout.block(
                f"if ({_has(value.source)})", [f"{target} = {self._made(value, source, type, path)};"]
            )

    def _made(self, value: Taken, text: str, type: InterfaceType, path: Path) -> str:
        """One value of a payload as the message has it."""
        source, shown = value.source, _shown(path)
        if source.type == "string":
            bound = f", {type.text_bound}" if type.text_bound else ""
            return f"roverlink::text({text}, {shown}{bound})"
        if value.scaling.is_identity and not source.enum and source.type == type.name:
            return text
        if source.type == "bool":
            return f"static_cast<{cpp_names.primitive(type.name)}>({text})"
        whole = source.is_integer and value.scaling.is_whole
        scaled = self._arithmetic.forth(_operand(text, source.type), value.scaling, whole=whole)
        if type.name.startswith("float"):
            scaled = f"static_cast<double>({scaled})" if whole else scaled
            scaled = f"std::nearbyint({scaled})" if value.rounded and not whole else scaled
            return f"roverlink::single({scaled}, {shown})" if type.name == "float32" else scaled
        return f"roverlink::{'narrow' if whole else 'rounded'}<{cpp_names.primitive(type.name)}>({scaled}, {shown})"

    def _angle(self, value: Taken | Constant) -> str:
        if isinstance(value, Constant):
            return literal(value.value)
        made = self._made(value, cpp_names.getter(value.source.path), InterfaceType("float64"), ())
        return made if value.default is None else f"{_has(value.source)} ? {made} : {literal(value.default)}"

    def _moment(self, value: Moment, path: Path) -> str:
        if value.source is None:
            return "received"
        whole = value.source.is_integer and value.nanoseconds.denominator == 1
        text = _operand(cpp_names.getter(value.source.path), value.source.type)
        scaled = text if value.nanoseconds == 1 else f"{text} * {_CPP.number(value.nanoseconds, whole=whole)}"
        nanoseconds = scaled if whole else f"roverlink::whole({scaled}, {_shown(path)})"
        return f"roverlink::stamp_of({nanoseconds}, {_shown(path)})"

    # --- from ROS ---

    def from_ros(self) -> Iterator[str]:
        """The statements of ``from_ros``, which make ``payload`` from ``message``."""
        if self._feed.obstacle:
            place = layout.text_literal(self._feed.message)
            yield f"throw roverlink::ConversionError({place}, {layout.text_literal(self._feed.obstacle)});"
            return
        yield f"{cpp_names.proto_class(self._feed.proto)} payload;"
        told: set[Path] = set()
        for index, recovered in enumerate(self._feed.recovered):
            for source, statements in self._recovered(recovered, index):
                if source is None or source.path not in told:
                    yield from statements
                    told |= {source.path} if source else set()
        yield "return payload;"

    def _recovered(self, recovered: Recovered, index: int) -> Iterator[tuple[Source | None, list[str]]]:
        """The statements that set fields of the payload, each with its field."""
        value, text = recovered.value, ".".join(("message", *recovered.path))
        if isinstance(value, Rotation):
            self.headers.add(cpp_names.runtime_header("rotations"))
            name = f"rotation{index or ''}"
            yield None, [f"const roverlink::Angles {name} = roverlink::angles({text});"]
            for angle, part in (("roll", value.roll), ("pitch", value.pitch), ("yaw", value.yaw)):
                if isinstance(part, Taken):
                    yield part.source, self._set(part, f"{name}.{angle}", "float64")
        elif isinstance(value, Taken):
            yield value.source, self._set(value, text, recovered.type.name)
        elif isinstance(value, Chosen):
            function = self._counterparts.back(value, recovered.path, recovered.type)
            yield value.source, [_setter(value.source, _as_declared(value.source, f"{function}({text})"))]
        elif value.source:
            number = self._unscaled_time(value, value.source, f"roverlink::nanoseconds({text})")
            yield value.source, [_setter(value.source, number)]

    def _set(self, value: Taken, text: str, type: str) -> list[str]:
        if not value.source.repeated or value.source.type == "bytes":
            return [_setter(value.source, self._untaken(value, text, type))]
        stored = _setter(value.source, self._untaken(value, "item", type))
        return layout.block(f"for (const auto & item : {text})", [stored])

    def _untaken(self, value: Taken, text: str, type: str) -> str:
        """One value of the message as the payload has it."""
        source, scaling = value.source, value.scaling
        shown = layout.text_literal(source.dotted)
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

    def _unscaled_time(self, value: Moment, source: Source, text: str) -> str:
        type, shown, factor = cpp_names.primitive(source.type), layout.text_literal(source.dotted), value.nanoseconds
        if source.is_integer and factor.denominator == 1:
            whole = text if factor == 1 else f"roverlink::floored({text}, {_CPP.number(factor, whole=True)})"
            return f"roverlink::narrow<{type}>({whole}, {shown})"
        divided = f"static_cast<double>({text})"
        divided += "" if factor == 1 else f" / {_CPP.number(factor, whole=False)}"
        return (
            f"roverlink::rounded<{type}>({divided}, {shown})"
            if source.is_integer
            else f"static_cast<{type}>({divided})"
        )


def _operand(text: str, type: str) -> str:
    """A number in arithmetic: whole ones are negated as such, for floats have two zeros."""
    return text if type.startswith("float") else f"roverlink::wide({text})"


def _as_declared(source: Source, text: str) -> str:
    return f"roverlink::Enumerator({text}, {layout.text_literal(source.dotted)})" if source.enum else text


def _setter(source: Source, value: str) -> str:
    *holders, name = source.path
    holder = "".join(["payload.", *(f"mutable_{cpp_names.accessor(part)}()->" for part in holders)])
    verb = "add" if source.repeated and source.type != "bytes" else "set"
    return f"{holder}{verb}_{cpp_names.accessor(name)}({value});"


def _has(source: Source) -> str:
    return f"{cpp_names.getter(source.path[:-1])}.has_{cpp_names.accessor(source.path[-1])}()"


def _shown(path: Path) -> str:
    """A field of the message for an error, as a literal."""
    return layout.text_literal(".".join(path))


def _constant(target: str, value: Value, type: InterfaceType) -> str:
    if not isinstance(value, tuple):
        return f"{target} = {literal(value)};"
    if len(set(value)) == 1 and len(value) > 1:
        if type.length is not None:
            return f"{target}.fill({literal(value[0])});"
        return f"{target}.assign({len(value)}, {literal(value[0])});"
    return f"{target} = {{{', '.join(map(literal, value))}}};"
