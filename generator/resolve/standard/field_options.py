"""Options of an entry under `fields`, apart from the source of the value: units, scale, offset and others.

Options of a message also apply to the fields inside.
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
"""Options that can be set for a message, and then apply to all fields inside."""


@dataclass(frozen=True, slots=True)
class Options:
    """Options that apply to a field: its own options, and those of the messages around it."""

    forms: Mapping[str, Form]
    negated: bool = False

    def within(self, form: Form) -> Options:
        """Return the options for the parts of a message: these options, overridden by those that stand in ``form``."""
        own = {key: entry for key, entry in (form.entries or {}).items() if key in SHARED}
        return dataclasses.replace(self, forms={**self.forms, **own})

    def signed(self, negated: bool) -> Options:
        """Return the options with the sign of the value changed once more, if ``negated`` is true."""
        return dataclasses.replace(self, negated=self.negated != negated)

    def text(self, key: str) -> str:
        """Return the value of an option as text; empty if the option is missing."""
        return str(self.forms[key].value) if key in self.forms else ""

    def number(self, key: str, otherwise: int) -> Fraction:
        """Return the value of an option as a number; ``otherwise`` if it is missing or no number."""
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
        """Return the name of the first of these options that is set; empty if none is set."""
        return next((key for key in keys if key in self.forms), "")


class Scalings:
    """Maker of the linear conversion of a number from its options. It checks that the units fit each other."""

    def __init__(self, report: Callable[[Diagnostic], None]) -> None:
        self._report = report

    def of(self, source: Source, place: Place, options: Options, span: Span) -> Scaling | None:
        """Return the linear conversion of a payload's field to a ROS field.

        Units that do not fit each other are reported, and the result is None.
        """
        for key in ("scale", "fixed_point", "offset"):
            if key in options.forms and not _is_usable(options.forms[key].value, key):
                message = (
                    f"`{key}` of {source.dotted!r} is {options.forms[key].value}; use a finite number other than 0"
                )
                self._report(standard_rules.WRONG_FORM.at(options.at(key, span), message))
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
            self._report(standard_rules.WRONG_FORM.at(options.at("to", span), message, "remove `to`"))
            return None
        wanted = place.unit or to
        if not wanted and unit:
            message = f"the unit of {place.shown} is not given, so the unit {unit!r} cannot be converted"
            self._report(
                standard_rules.UNIT_MISSING.at(options.at("unit", span), message, "add `to`, or remove `unit`")
            )
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
                standard_rules.UNIT_MISSING.at(
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
            message = (
                f"{source.dotted!r} is in {_told(given[0], out_of)}, but {place.shown} is in {_told(wanted[0], into)}"
            )
            known = "g means gram; write g0 for the acceleration of free fall" if given[0] in ("g", "mg") else ""
            self._report(
                standard_rules.DIMENSION.at(
                    span, message, known or f"use a unit that converts to {wanted[0]}, or another field"
                )
            )
            return None
        return dataclasses.replace(units.conversion(out_of, into), unit=given[0], to=wanted[0])

    def _parsed(self, text: str, span: Span) -> units.Unit | None:
        try:
            return units.parse(text)
        except units.UnitError as error:
            self._report(standard_rules.UNKNOWN_UNIT.at(span, str(error)))
            return None


def _is_usable(value: object, key: str) -> bool:
    return isinstance(value, (int, Fraction)) and (bool(value) or key == "offset")


def _told(text: str, unit: units.Unit) -> str:
    """Return a unit as text for a message, with its base units in brackets if they are written differently."""
    return text if text == unit.in_si else f"{text} ({unit.in_si})"
