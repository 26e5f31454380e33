"""Filling of a standard message: the table's entries under `fields` become expressions for the message's fields.

An expression describes how a field gets its value. The named axes, such as ``ned_to_enu``, follow REP 103. ROS uses x
east, y north, z up (ENU) on a map, and x forward, y left, z up (FLU) on a body. Many boards report north-east-down
(NED) or forward-right-down (FRD).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.interfaces import (
    BoardTime,
    Constant,
    Expression,
    InterfaceType,
    Moment,
    Path,
    Rotation,
    Taken,
    Unset,
)
from roverlink.generator.resolve import units
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.resolve.standard.field_options import Options
from roverlink.generator.resolve.standard.leaves import Leaves
from roverlink.generator.resolve.standard.message_fields import Place, Places
from roverlink.generator.resolve.standard.payload_fields import Sources
from roverlink.generator.table import Form
from roverlink.generator.table.keys import OPTIONS
from roverlink.suggestions import nearest

_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
_QUATERNION = "geometry_msgs/msg/Quaternion"
# The source axis for each of x, y and z. Each of the two rotations is its own inverse (REP 103).
_NAMED_AXES = {"ned_to_enu": ("y", "x", "-z"), "frd_to_flu": ("x", "-y", "-z")}
_ANGLES = ("roll", "pitch", "yaw")
_NO_OPTIONS = Options({})
_SECOND = units.parse("s")
_COUNTERS = ("uint32", "uint64", "int64")
"""Types of a board's clock. A 32-bit counter with a sign is negative for half of the time; a 64-bit one never is."""
_COARSEST = 10**6
"""Most nanoseconds of one unit of a board's clock."""


class Filling:
    """Collector of the expressions for the fields of one standard message. An expression gives a field its value."""

    def __init__(self, places: Places, sources: Sources, report: Callable[[Diagnostic], None]) -> None:
        self.places, self.sources, self._report = places, sources, report
        self._leaves = Leaves(sources, places.definition, report)
        self.expressions: dict[Path, Expression] = {}
        self.spans: dict[Path, Span] = {}
        self.unplaced: list[Span] = []
        """Places of table entries whose path leads to no field. It is unknown which field they were meant to fill."""

    def add(self, path: Path, form: Form, options: Options = _NO_OPTIONS) -> None:
        """Add the expressions for a field, or for all fields inside it, from the table's entry ``form``.

        Mistakes are reported.
        """
        place = self.places.find(path, form.span)
        if place is None:
            self.unplaced.append(form.span)
        elif place.type.is_message:
            self._add_message(place, form, options)
        else:
            self.put(place.path, self._leaf(place, form, options), form.span)

    def put(self, path: Path, expression: Expression | None, span: Span) -> None:
        """Add the expression for a field. If the field has an expression already, report that.

        An ``expression`` of None stands for an entry whose mistake has been reported.
        """
        self.spans.setdefault(path, span)
        if expression is None:
            self.expressions.setdefault(
                path, Unset()
            )  # the mistake is reported already; avoid more diagnostics about this field
            return
        for other in self.expressions:
            if other[: len(path)] == path or path[: len(other)] == other:
                also = [(self.spans[other], f"'{'.'.join(other)}' is filled here")]
                message = f"the field '{'.'.join(path)}' is filled twice"
                self._report(
                    standard_rules.TargetFieldSetTwice.at(span, message, "keep only one of the two entries", also)
                )
                return
        self.expressions[path] = expression

    # --- messages ---

    def _add_message(self, place: Place, form: Form, options: Options) -> None:
        if place.type.name in _TIMES and not place.type.is_many:
            self.put(place.path, self.moment(place, form), form.span)
        elif place.type.is_many:
            message = f"{place.shown} is a {place.type}; lists of messages cannot be filled yet"
            self._wrong(form.span, message, place.path)
        elif form.entries is None:
            names = ", ".join(field.name for field in self.places.definition(place.type.name).fields)
            self._wrong(form.span, f"{place.shown} is a message; fill its fields: {names}", place.path)
        elif "euler" in form.entries:
            self._add_rotation(place, form)
        else:
            self._add_parts(place, form, form.entries, options.within(form))

    def _add_parts(self, place: Place, form: Form, entries: Mapping[str, Form], options: Options) -> None:
        for key in ("from", "value", "enum"):
            if key in entries:
                message = (
                    f"{place.shown} is a message, but `{key}` sets a single value; write `{key}` for a field inside it"
                )
                self._wrong(entries[key].span, message, place.path)
        parts = {name: entry for name, entry in entries.items() if name not in OPTIONS}
        if "axes" not in entries:
            for name, entry in parts.items():
                self.add((*place.path, name), entry, options)
            return
        axes = self._axes(place, entries["axes"])
        if axes and set(parts) != {"x", "y", "z"}:
            self._wrong(
                form.span,
                f"`axes` needs entries for x, y and z, but {place.dotted!r} has {', '.join(parts) or 'none'}",
                place.path,
            )
        elif axes:
            for name, axis in zip("xyz", axes):
                entry, signed = parts[axis.removeprefix("-")], options.signed(axis.startswith("-"))
                self.add((*place.path, name), entry, signed)

    def _axes(self, place: Place, form: Form) -> tuple[str, ...]:
        """Return the source axis for each of x, y and z: ``("y", "x", "-z")`` for ``ned_to_enu``.

        Wrong axes are reported, and the result is empty.
        """
        if isinstance(form.value, str):
            return _NAMED_AXES[form.value]
        axes = tuple(str(item.value) for item in form.items or ())
        if sorted(axis.removeprefix("-") for axis in axes) == ["x", "y", "z"]:
            return axes
        self._wrong(
            form.span, f"`axes` of {place.dotted!r} must contain each of x, y and z once, as in [y, x, -z]", place.path
        )
        return ()

    def _add_rotation(self, place: Place, form: Form) -> None:
        entries = form.entries or {}
        others = [name for name in entries if name != "euler"]
        if place.type.name != _QUATERNION or others:
            if others:
                extra = ", ".join(f"`{name}`" for name in others)
                message = f"`euler` sets all of {place.shown}; remove {extra}"
            else:
                message = f"`euler` sets a geometry_msgs/Quaternion, but {place.shown} is a {place.type}"
            self._wrong(form.span, message, place.path)
            return
        euler = entries["euler"]
        angles = euler.entries or {}
        options = _NO_OPTIONS.within(euler)
        # Roll, pitch and yaw are about the fixed axes X, Y and Z, in this order (REP 103, "Rotation
        # Representation").
        made = [self._angle(place, name, angles[name], options) for name in _ANGLES if name in angles]
        whole = [angle for angle in made if angle is not None]
        self.put(place.path, Rotation(*whole) if len(whole) == len(_ANGLES) else None, form.span)

    def _angle(self, place: Place, name: str, form: Form, options: Options) -> Taken | Constant | None:
        angle = _AnglePlace((*place.path, name), InterfaceType("float64"), place.holders)
        made = self._leaf(angle, form, options)
        if made is None or isinstance(made, (Taken, Constant)):
            return made
        self._wrong(form.span, f"the angle {name!r} must be a number", ())
        return None

    # --- times ---

    def stamp(self, place: Place, form: Form) -> Moment | None:
        """Return the expression for the stamp of a header; only this can be by the clock of the board."""
        entries = dict(form.entries or {})
        clock = entries.pop("clock", None)
        if clock is None:
            return self.moment(place, form)
        moment = self.moment(place, replace(form, entries=entries))
        if moment is None or moment.source is None:
            return None
        source, unit = moment.source, entries["unit"]
        if source.type not in _COUNTERS:
            message = f"{source.dotted!r} is a {source.type}, which cannot be the counter of a board"
            help = "use a field of the type uint32, uint64, fixed32, fixed64 or int64"
            self._report(standard_rules.NoBoardClock.at(entries["from"].span, message, help))
            return None
        if moment.nanoseconds.denominator != 1 or moment.nanoseconds > _COARSEST:
            message = f"a stamp in {unit.value} is no time of measuring"
            self._report(standard_rules.NoBoardClock.at(unit.span, message, "let the board count ms, us or ns"))
            return None
        if moment.nanoseconds == 1 and source.bits == 32:
            message = f"{source.dotted!r} has 32 bits, so a counter in ns begins again at 0 after 4 s"
            self._report(standard_rules.NoBoardClock.at(unit.span, message, "use a field of 64 bits, or count us"))
            return None
        return BoardTime(source=None, nanoseconds=moment.nanoseconds, counter=source)

    def moment(self, place: Place, form: Form) -> Moment | None:
        """Return the expression for a time or duration: the time of reception, or the value of a payload's field."""
        if form.value == "receive" and place.type.name == _TIMES[0]:
            return Moment(None)
        entries = form.entries or {}
        if set(entries) != {"from", "unit"}:
            message = f"{place.shown} is a {place.type}: write {{from: a proto field, unit: ms}}"
            self._report(
                standard_rules.MappingDoesNotFit.at(
                    form.span, message, "or write `receive` for the time at which the datagram arrived"
                )
            )
            return None
        source = self.sources.find(str(entries["from"].value), entries["from"].span)
        seconds = self._seconds(place, entries["unit"])
        if source is None or seconds is None:
            return None
        if source.type in ("string", "bool", "bytes") or source.enum or source.repeated or source.optional:
            message = f"{place.shown} needs a single number that is never absent; {source.dotted!r} is not such a field"
            self._report(standard_rules.MappingDoesNotFit.at(entries["from"].span, message))
            return None
        # In nanoseconds: builtin_interfaces/Time has whole seconds and whole nanoseconds.
        return Moment(source, seconds * 10**9)

    def _seconds(self, place: Place, form: Form) -> Fraction | None:
        """Return the number of seconds in the unit of time that an entry names: 1/1000 for ``ms``.

        If the unit is no unit of time, this is reported, and the result is None.
        """
        try:
            unit = units.parse(str(form.value))
        except units.UnitError as error:
            self._report(standard_rules.UnknownUnit.at(form.span, str(error)))
            return None
        if unit.dimension != _SECOND.dimension:
            message = f"{place.shown} is a time, but {form.value!r} is not a unit of time"
            self._report(standard_rules.DimensionDoesNotFit.at(form.span, message, "use a unit of time: s, ms, us, ns"))
            return None
        return unit.factor

    # --- single values ---

    def _leaf(self, place: Place, form: Form, options: Options) -> Expression | None:
        if isinstance(form.value, str):
            return self._leaves.taken(place, form.value, options, form.span)
        if form.entries is None:
            return self._leaves.constant(place, form, options.negated)
        entries = form.entries
        if others := [name for name in entries if name not in OPTIONS]:
            help = nearest(others[0], OPTIONS, f"known here: {', '.join(OPTIONS)}")
            message = f"{place.shown} is a {place.type}, which has no part {others[0]!r}"
            self._report(standard_rules.UnknownTargetField.at(entries[others[0]].span, message, help))
            return None
        if ("from" in entries) == ("value" in entries) or "euler" in entries or "axes" in entries:
            message = f"{place.shown} needs either `from` (a proto field) or `value` (a constant)"
            self._report(standard_rules.MappingDoesNotFit.at(form.span, message))
            return None
        own = options.within(form)
        if "value" in entries:
            return self._leaves.constant(place, entries["value"], options.negated)
        if "enum" in entries:
            return self._leaves.chosen(place, str(entries["from"].value), entries["enum"], own)
        return self._leaves.taken(place, str(entries["from"].value), own, entries["from"].span)

    def _wrong(self, span: Span, message: str, path: Path) -> None:
        self._report(standard_rules.MappingDoesNotFit.at(span, message))
        if path:
            self.put(path, None, span)


class _AnglePlace(Place):
    """Angle from which a quaternion is computed. It has no field of its own in the standard message."""

    __slots__ = ()

    @property
    def unit(self) -> str:
        """Unit to which the angle is converted: always the radian."""
        return "rad"
