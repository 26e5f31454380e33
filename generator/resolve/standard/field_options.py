"""Options of an entry under `fields`, such as the unit and the scale in ``{from: x, unit: cm, scale: 2}``.

An option for a field that contains a message also applies to the fields inside this message.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.interfaces import Scaling, Source
from roverlink.generator.resolve import units
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.resolve.standard.message_fields import Place
from roverlink.generator.table import Form

SHARED = ("unit", "to", "scale", "fixed_point", "offset", "narrow", "default")
"""Options that can be set for a field that contains a message, and then apply to all fields inside the message."""


@dataclass(frozen=True, slots=True)
class Options:
    """Options that apply to a field of a standard message: its own options, and those of the messages around it."""

    forms: Mapping[str, Form]
    """Value of each option, with its place in the table, by the option's name."""
    negated: bool = False
    """True if the value changes its sign, because of a - before the path or before an axis."""

    def within(self, form: Form) -> Options:
        """Return these options, together with or replaced by the options that the entry ``form`` sets."""
        own = {key: entry for key, entry in (form.entries or {}).items() if key in SHARED}
        return dataclasses.replace(self, forms={**self.forms, **own})

    def signed(self, negated: bool) -> Options:
        """Return these options; if ``negated`` is true, the value changes its sign once more.

        Two changes of the sign cancel each other.
        """
        return dataclasses.replace(self, negated=self.negated != negated)

    def text(self, key: str) -> str:
        """Return the value of an option as text; empty if the option is missing."""
        return str(self.forms[key].value) if key in self.forms else ""

    def number(self, key: str, otherwise: int) -> Fraction:
        """Return the value of an option as a number; ``otherwise`` if the option is missing or is not a number."""
        value = self.forms[key].value if key in self.forms else otherwise
        return Fraction(value) if isinstance(value, (int, Fraction)) else Fraction(otherwise)

    def at(self, key: str, otherwise: Span) -> Span:
        """Return the place of an option in the table; ``otherwise`` if the option is missing."""
        return self.forms[key].span if key in self.forms else otherwise

    @property
    def narrow(self) -> bool:
        """True if the table allows a ROS field with less precision, or a smaller range, than the payload's field."""
        return "narrow" in self.forms and self.forms["narrow"].value is True

    def stated(self, *keys: str) -> str:
        """Return the first name in ``keys`` whose option is set; empty if none of them is set."""
        return next((key for key in keys if key in self.forms), "")


class Scalings:
    """Builder of the linear conversion (factor and offset) from a payload field to a field of a standard message.

    It follows the field's options, and checks that the units of the two fields have the same dimension.
    """

    def __init__(self, report: Callable[[Diagnostic], None]) -> None:
        self._report = report

    def of(self, source: Source, place: Place, options: Options, span: Span) -> Scaling | None:
        """Return the linear conversion from the payload field ``source`` to the field ``place`` of a standard message.

        A wrong number or unit in the options is reported, and the result is None.
        """
        for key in ("scale", "fixed_point", "offset"):
            if key in options.forms and not _is_usable(options.forms[key].value, key):
                value = options.forms[key].value
                wanted = "a finite number" if key == "offset" else "a finite number other than 0"
                message = f"`{key}` of {source.dotted!r} is {value}; it must be {wanted}"
                help = f"correct or remove `{key}`"
                self._report(standard_rules.MappingDoesNotFit.at(options.at(key, span), message, help))
                return None
        scale = options.number("scale", 1)
        if "fixed_point" in options.forms:
            scale /= options.number("fixed_point", 1)
        offset = options.number("offset", 0)
        sign = -1 if options.negated else 1
        if (found := self._units(source, place, options, span)) is None:
            return None
        unit = found
        # The order of the table's documentation: scale, then offset, both in the unit of the proto field; then the
        # conversion of the unit; then the sign of the axis. Fractions keep this exact, and only the generated code
        # rounds.
        factor, shift = scale * unit.factor * sign, (offset * unit.factor + unit.offset) * sign
        return Scaling(factor, shift, unit.pi, unit.unit, unit.to)

    def _units(self, source: Source, place: Place, options: Options, span: Span) -> Scaling | None:
        unit, to = options.text("unit"), options.text("to")
        if place.unit and to:
            message = f"{place.shown} is always in {place.unit} by its definition, so `to` cannot change it"
            self._report(standard_rules.MappingDoesNotFit.at(options.at("to", span), message, "remove `to`"))
            return None
        wanted = place.unit or to
        if not wanted and unit:
            message = f"the unit of {place.shown} is not given, so the unit {unit!r} cannot be converted"
            self._report(standard_rules.UnitMissing.at(options.at("unit", span), message, "add `to`, or remove `unit`"))
            return None
        if not wanted:
            return Scaling()
        into = self._parsed(wanted, options.at("to", span))
        # Where a ratio is wanted, a number without a unit can only be a ratio.
        if not unit and into == units.parse("1"):
            unit = "1"
        if not unit:
            message = f"{place.shown} is in {wanted}, but the unit of {source.dotted!r} is not given"
            self._report(
                standard_rules.UnitMissing.at(
                    span,
                    message,
                    f"add `unit: {wanted}` if {source.dotted!r} is in {wanted}, or else the unit that it has",
                )
            )
            return None
        out_of = self._parsed(unit, options.at("unit", span))
        return self._conversion(source, place, (unit, out_of), (wanted, into), options.at("unit", span))

    def _conversion(
        self,
        source: Source,
        place: Place,
        given: tuple[str, units.Unit | None],
        wanted: tuple[str, units.Unit | None],
        span: Span,
    ) -> Scaling | None:
        out_of, into = given[1], wanted[1]
        if out_of is None or into is None:
            return None
        if out_of.dimension != into.dimension:
            in_si = _with_si_unit(given[0], out_of), _with_si_unit(wanted[0], into)
            message = f"{source.dotted!r} is in {in_si[0]}, but {place.shown} is in {in_si[1]}"
            known = "g means gram; write g0 for the acceleration of free fall" if given[0] in ("g", "mg") else ""
            self._report(
                standard_rules.DimensionDoesNotFit.at(
                    span, message, known or f"use a unit that converts to {wanted[0]}, or another field"
                )
            )
            return None
        return dataclasses.replace(units.conversion(out_of, into), unit=given[0], to=wanted[0])

    def _parsed(self, text: str, span: Span) -> units.Unit | None:
        try:
            return units.parse(text)
        except units.UnitError as error:
            self._report(standard_rules.UnknownUnit.at(span, str(error)))
            return None


def _is_usable(value: object, key: str) -> bool:
    return isinstance(value, (int, Fraction)) and (bool(value) or key == "offset")


def _with_si_unit(text: str, unit: units.Unit) -> str:
    """Return a unit as text for a diagnostic, followed by its SI base units if they differ: ``N (m kg s^-2)``."""
    return text if text == unit.in_si else f"{text} ({unit.in_si})"
