"""How Python spells what fills a standard message, and what tells a payload's fields."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from roverlink.generator.emit.arithmetic import Arithmetic, Dialect
from roverlink.generator.emit.targets.python import interfaces, layout, spelling
from roverlink.generator.emit.targets.python.layout import Comprehension, Conditional, Group, Item
from roverlink.generator.ir import Feed
from roverlink.generator.ir.interfaces import (
    Case,
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
    Unset,
    Value,
)

_SECOND = 1_000_000_000
_PYTHON = Dialect(separator="_", pi="math.pi", power="{base}**{exponent}", constant="_{name}")


class FeedSpelling:
    """Spells one feed, and keeps what its module needs."""

    def __init__(self, feed: Feed, generated: str) -> None:
        self._feed, self._generated = feed, generated
        self._arithmetic = Arithmetic(_PYTHON)
        self._tables: dict[str, str] = {}
        self._module = spelling.proto_module(feed.file)
        self.imports: set[tuple[str, str]] = {interfaces.import_of(feed.message, generated)}
        self.locals: list[str] = []
        """What ``pack`` works out before its call."""

    def constants(self) -> Iterator[str]:
        """What stands above the class."""
        yield from (f"{name} = {value}" for name, value in self._arithmetic.constants.items())
        yield from (f"{name} = {value}" for name, value in self._tables.items())

    # --- to ROS ---

    def message(self, fields: Iterable[TargetField], name: str, head: str = "", *, varying: bool = True) -> Group:
        """A message; without what varies, where that is not wanted."""
        self.imports.add(interfaces.import_of(name, self._generated))
        items = [item for field in fields if (item := self._argument(field, varying)) is not None]
        return Group(f"{head}{interfaces.reference(name)}(", items, ")")

    def _argument(self, field: TargetField, varying: bool) -> Item | None:
        head, value = f"{field.name}=", field.value
        if isinstance(value, Parts):
            parts = self.message(value.fields, field.type.name, head, varying=varying)
            return parts if parts.items or varying else None
        if isinstance(value, Constant):
            return _constant(head, value.value, field.type)
        if isinstance(value, Unset) or not varying:
            return None
        if isinstance(value, Rotation):
            self.imports.add(interfaces.import_of(field.type.name, self._generated))
            return Group(f"{head}{interfaces.reference(field.type.name)}(", [self._rotation(value)], ")")
        if isinstance(value, Moment):
            if value.source is None:
                return f"{head}stamp"
            self.imports.add(interfaces.import_of(field.type.name, self._generated))
            return Group(f"{head}{interfaces.reference(field.type.name)}(", [self._moment(value)], ")")
        return self._value(head, value)

    def values(self, field: TargetField) -> list[Item]:
        """What varies of a field, as arguments for `struct` in wire order."""
        value = field.value
        if isinstance(value, Parts):
            return [item for part in value.fields for item in self.values(part)]
        if isinstance(value, Rotation):
            return self._unpacked(self._rotation(value), "xyzw")
        if isinstance(value, Moment) and value.source is None:
            return ["stamp.sec", "stamp.nanosec"]
        if isinstance(value, Moment):
            return self._unpacked(self._moment(value), ("sec", "nanosec"))
        if isinstance(value, Taken) and value.source.repeated:
            return [self._list("*", value)]
        return [self._value("", value)] if isinstance(value, (Taken, Chosen)) else []

    def _unpacked(self, call: Group, names: Iterable[str]) -> list[Item]:
        """Names for what a call returns: cheaper than to spread it among other arguments."""
        own = [f"{name}{len(self.locals) or ''}" for name in names]
        call = dataclasses.replace(call, head=f"{', '.join(own)} = {call.head.removeprefix('*')}")
        self.locals.append(layout.statement(call, 8))
        return list(own)

    def _value(self, head: str, value: Taken | Chosen) -> Item:
        if isinstance(value, Chosen):
            return f"{head}{self._chosen(value)}"
        if value.source.repeated:
            return self._list(head, value)
        if value.default is None:
            return f"{head}{self._taken(value, _payload(value.source))}"
        *holders, name = value.source.path
        condition = f'{".".join(("payload", *holders))}.HasField("{name}")'
        return Conditional(head, self._taken(value, _payload(value.source)), condition, _literal(value.default))

    def _list(self, head: str, value: Taken) -> Item:
        source, item = _payload(value.source), self._taken(value, "item")
        if item == "item":
            return f"{head}{source}" if head == "*" else Group(f"{head}list(", [source], ")")
        return Comprehension(f"{head}[", item, f"for item in {source}", "]")

    def _taken(self, value: Taken, text: str) -> str:
        source = value.source
        whole = source.is_integer and value.scaling.is_whole
        scaled = self._arithmetic.forth(text, value.scaling, whole=whole)
        return f"round({scaled})" if value.rounded else scaled

    def _chosen(self, value: Chosen) -> str:
        name = self._table(value)
        if value.default is None:
            return f"{name}[{_payload(value.source)}]"
        default = self._case(value.default, value.holder)
        return f"{name}.get({_payload(value.source)}, {default})"

    def _table(self, value: Chosen) -> str:
        """The name of the table of an enum's counterparts."""
        self.imports |= {
            ("roverlink.runtime.core.feed", "Counterparts"),
            interfaces.import_of(value.holder, self._generated),
        }
        cases = [f"{case.number}: {self._case(case, value.holder)},  # {case.name}" for case in value.cases]
        body = [f'    "{value.source.dotted}",', "    {", *(f"        {case}" for case in cases), "    },", ")"]
        text, name = "\n".join(["Counterparts(", *body]), f"_{'_'.join(value.source.path).upper()}"
        while self._tables.setdefault(name, text) != text:
            name += "_"
        return name

    def _case(self, case: Case, holder: str) -> str:
        return f"{interfaces.reference(holder)}.{case.constant}" if case.constant else _literal(case.value)

    def _rotation(self, value: Rotation) -> Group:
        self.imports.add(("roverlink.runtime.convert", "rotations"))
        parts = (value.roll, value.pitch, value.yaw)
        angles = [_literal(part.value) if isinstance(part, Constant) else self._value("", part) for part in parts]
        return Group("*rotations.quaternion(", angles, ")")

    def _moment(self, value: Moment) -> Group:
        source = value.source
        text = _payload(source) if source else ""
        whole = source is not None and source.is_integer and value.nanoseconds.denominator == 1
        scaled = text if value.nanoseconds == 1 else f"{text} * {_PYTHON.number(value.nanoseconds, whole=whole)}"
        return Group("*divmod(", [scaled if whole else f"round({scaled})", f"{_SECOND:_}"], ")")

    # --- from ROS ---

    def statements(self) -> list[str]:
        """The body of ``from_ros``."""
        if self._feed.obstacle:
            self.imports.add(("roverlink.runtime.core.errors", "ConversionError"))
            return [layout.statement(Group("raise ConversionError(", [_literal(self._feed.obstacle)], ")"), 8)]
        lines, found = [], dict[Path, Item]()
        for index, recovered in enumerate(self._feed.recovered):
            if isinstance(recovered.value, Rotation):
                names = [f"{angle}{index or ''}" for angle in ("roll", "pitch", "yaw")]
                lines.append(layout.line(self._angles(recovered, names), 8))
                parts = (recovered.value.roll, recovered.value.pitch, recovered.value.yaw)
                for part, name in zip(parts, names):
                    if isinstance(part, Taken):
                        found.setdefault(part.source.path, self._untaken(part, name, "float64"))
            else:
                for source, item in self._recovered(recovered):
                    found.setdefault(source.path, item)
        payload = f"{self._module}.{self._feed.local_name}"
        call = Group(f"return {payload}(", list(_nested(sorted(found.items(), key=lambda pair: pair[0][:-1]), 0)), ")")
        return [*lines, layout.statement(call, 8)]

    def _angles(self, recovered: Recovered, names: Sequence[str]) -> str:
        self.imports.add(("roverlink.runtime.convert", "rotations"))
        rotation = recovered.value
        parts = (rotation.roll, rotation.pitch, rotation.yaw) if isinstance(rotation, Rotation) else ()
        targets = [name if isinstance(part, Taken) else f"_{name}" for name, part in zip(names, parts)]
        return f"{', '.join(targets)} = rotations.angles({_message(recovered.path)})"

    def _recovered(self, recovered: Recovered) -> Iterator[tuple[Source, Item]]:
        value, text = recovered.value, _message(recovered.path)
        if isinstance(value, Taken):
            yield value.source, self._untaken(value, text, recovered.type.name)
        elif isinstance(value, Chosen):
            name = self._table(value)
            self._tables[f"{name}_BACK"] = f'{name}.back("{".".join(recovered.path)}")'
            yield value.source, f"{name}_BACK[{text}]"
        elif isinstance(value, Moment) and value.source:
            self.imports.add(("roverlink.runtime.core.feed", "nanoseconds"))
            yield value.source, _unscaled_time(value.source, value.nanoseconds, f"nanoseconds({text})")

    def _untaken(self, value: Taken, text: str, type: str) -> Item:
        source, scaling = value.source, value.scaling
        item = "item" if source.repeated else text
        whole = source.is_integer and scaling.is_whole and abs(scaling.factor) == 1 and not type.startswith("float")
        back = self._arithmetic.back(item, scaling, whole=whole)
        if source.is_integer and not whole:
            back = f"round({back})"
        elif source.type == "float32" and (type == "float64" or not scaling.is_identity):
            self.imports.add(("roverlink.runtime.core.feed", "single"))
            back = f"single({back})"
        if not source.repeated:
            return back
        return text if back == "item" else Comprehension("[", back, f"for item in {text}", "]")


def _nested(found: list[tuple[Path, Item]], depth: int) -> Iterator[Item]:
    """Keyword arguments, and below them the entries of the mappings that stand for the messages between."""
    for name, group in itertools.groupby(found, lambda pair: pair[0][depth]):
        head = f'"{name}": ' if depth else f"{name}="
        members = list(group)
        if len(members[0][0]) == depth + 1:
            yield from (layout.headed(head, item) for _, item in members)
        else:
            yield Group(f"{head}{{", list(_nested(members, depth + 1)), "}")


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


def _constant(head: str, value: Value, type: InterfaceType) -> Item:
    if not isinstance(value, tuple):
        return f"{head}{_literal(value)}"
    if type.name == "uint8":
        return f"{head}bytes([{', '.join(map(str, value))}])" if any(value) else f"{head}bytes({len(value)})"
    if len(set(value)) == 1 and len(value) > 1:
        return f"{head}[{_literal(value[0])}] * {len(value)}"
    return Group(f"{head}[", [_literal(item) for item in value], "]")


def _literal(value: object) -> str:
    if isinstance(value, str):
        mark = "'" if value.count('"') > value.count("'") else '"'
        escaped = value.replace("\\", "\\\\").replace(mark, f"\\{mark}")
        return f"{mark}{escaped}{mark}" if escaped.isprintable() else ascii(value)
    if isinstance(value, float) and not math.isfinite(value):
        return "math.nan" if math.isnan(value) else ("math.inf" if value > 0 else "-math.inf")
    return repr(value)
