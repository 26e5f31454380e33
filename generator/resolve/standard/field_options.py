"""What a mapping says besides the field that it takes: units, scale and offset, and what belongs to all its parts."""

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
"""The options that stand for all parts."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options for a number, its own and those that it shares with others."""

    forms: Mapping[str, Form]
    negated: bool = False

    def within(self, form: Form) -> Options:
        """These, and those of a form, which count for more."""
        own = {key: entry for key, entry in (form.entries or {}).items() if key in SHARED}
        return dataclasses.replace(self, forms={**self.forms, **own})

    def turned(self, negated: bool) -> Options:
        """The same, for what is negated once more."""
        return dataclasses.replace(self, negated=self.negated != negated)

    def text(self, key: str) -> str:
        """An option as text; empty where it is not there."""
        return str(self.forms[key].value) if key in self.forms else ""

    def number(self, key: str, otherwise: int) -> Fraction:
        """An option as a number."""
        value = self.forms[key].value if key in self.forms else otherwise
        return Fraction(value) if isinstance(value, (int, Fraction)) else Fraction(otherwise)

    def at(self, key: str, otherwise: Span) -> Span:
        """Where an option stands."""
        return self.forms[key].span if key in self.forms else otherwise

    @property
    def narrow(self) -> bool:
        """Whether something may be lost."""
        return "narrow" in self.forms and self.forms["narrow"].value is True

    def stated(self, *keys: str) -> str:
        """The first of some options that is there; empty for none."""
        return next((key for key in keys if key in self.forms), "")


class Scalings:
    """Makes the scaling of a number from its options, and checks the units."""

    def __init__(self, report: Callable[[Diagnostic], None]) -> None:
        self._report = report

    def of(self, source: Source, place: Place, options: Options, span: Span) -> Scaling | None:
        """The scaling; None, with a finding, where the units do not fit."""
        for key in ("scale", "fixed_point", "offset"):
            if key in options.forms and not _is_usable(options.forms[key].value, key):
                message = f"{key} is {options.forms[key].value}, by which {source.dotted} would say nothing"
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
        factor, shift = scale * unit.factor * sign, (offset * unit.factor + unit.offset) * sign
        return Scaling(factor, shift, unit.pi, unit.unit, unit.to)

    def _units(self, source: Source, place: Place, options: Options, span: Span) -> Scaling | None:
        unit, to = options.text("unit"), options.text("to")
        if place.unit and to:
            message = f"{place.shown} is in {place.unit} by its definition, so that `to` cannot say it"
            self._report(standard_rules.WRONG_FORM.at(options.at("to", span), message, "remove `to`"))
            return None
        wanted = place.unit or to
        if not wanted and unit:
            message = f"nothing says in which unit {place.shown} is, so that {unit} cannot be converted"
            self._report(
                standard_rules.UNIT_MISSING.at(options.at("unit", span), message, "say `to`, or remove `unit`")
            )
            return None
        if not wanted:
            return Scaling()
        into = self._parsed(wanted, options.at("to", span))
        if not unit and into == units.parse("1"):
            unit = "1"
        if not unit:
            message = f"{place.shown} is in {wanted}, and nothing says in which unit {source.dotted} is"
            self._report(
                standard_rules.UNIT_MISSING.at(span, message, f"say it: `unit: {wanted}`, if that is the unit")
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
            message = f"{source.dotted} is in {_told(given[0], out_of)}, and {place.shown} in {_told(wanted[0], into)}"
            known = "g is the gram; the acceleration of free fall is g0" if given[0] in ("g", "mg") else ""
            self._report(
                standard_rules.DIMENSION.at(span, message, known or f"give a unit as {wanted[0]} is, or another field")
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
    """A unit, and what it is in the SI where that looks different."""
    return text if text == unit.in_si else f"{text} ({unit.in_si})"
