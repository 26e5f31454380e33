"""Expressions for fields of a standard message that are not messages themselves, such as numbers and texts.

An expression describes how the field gets its value: from a field of the payload, from a constant, or from a choice by
an enum value.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from fractions import Fraction

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.interfaces import Case, Chosen, Constant, Interface, Source, Taken
from roverlink.generator.resolve import numeric_ranges
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.resolve.standard.field_options import Options, Scalings
from roverlink.generator.resolve.standard.message_fields import Place, short
from roverlink.generator.resolve.standard.payload_fields import Sources
from roverlink.generator.table import Form
from roverlink.suggestions import nearest


class Leaves:
    """Builder of the expressions for fields of a standard message that are not messages themselves.

    Mistakes in the row are reported with the function ``report``, which the constructor gets.
    """

    def __init__(
        self, sources: Sources, definition: Callable[[str], Interface], report: Callable[[Diagnostic], None]
    ) -> None:
        self._sources, self._definition, self._report = sources, definition, report
        self._scalings = Scalings(report)

    # --- fields of the payload ---

    def taken(self, place: Place, text: str, options: Options, span: Span) -> Taken | Chosen | None:
        """Return the expression that takes the value from a field of the payload.

        ``text`` is the path of this field, such as ``accel.x``; a - before the path negates the value. A mistake is
        reported, and the result is None.
        """
        source = self._sources.find(text.removeprefix("-"), span)
        if source is None:
            return None
        options = options.signed(text.startswith("-"))
        if source.enum:
            values = ", ".join(f"{name}: ..." for name in self._sources.values_of(source.enum))
            help = f"add the result for each value: `enum: {{{values}}}`"
            message = f"{source.dotted!r} is an enum, whose numbers have no meaning in {place.shown}"
            self._report(standard_rules.MappingDoesNotFit.at(span, message, help))
            return None
        if why := self._misfit(source, place):
            help = f"use a proto field that fits a {place.type}, or fill another field of the message"
            self._report(standard_rules.MappingDoesNotFit.at(span, why, help))
            return None
        if not _is_number(source.type):
            return self._unscaled(source, place, options, span)
        return self._number(source, place, options, span)

    def _misfit(self, source: Source, place: Place) -> str:
        """Return the reason why the type of a payload field does not fit the field ``place``; empty if it fits."""
        type = place.type
        many = source.repeated or source.type == "bytes"
        if many != type.is_many:
            has, needs = ("a list", "a single value") if many else ("a single value", "a list")
            return f"{source.dotted!r} is {has}, but {place.shown} needs {needs}: it is a {type}"
        kinds = ("bytes", "uint8") if source.type == "bytes" else (source.type, type.name)
        if _kind(kinds[0]) != _kind(kinds[1]) and kinds[0] != "bytes":
            return f"{source.dotted!r} is a {source.type}, but {place.shown} is a {type}"
        if source.type == "bytes" and type.name not in ("uint8", "byte", "char"):
            return f"{source.dotted!r} has the type bytes, but {place.shown} is a {type}"
        return ""

    def _unscaled(self, source: Source, place: Place, options: Options, span: Span) -> Taken | None:
        key = options.stated("unit", "to", "scale", "fixed_point", "offset")
        if key or options.negated:
            sign = f"`{key}`" if key else "the minus sign"
            message = f"{source.dotted!r} is a {source.type}, so {sign} has no meaning for it"
            self._report(standard_rules.MappingDoesNotFit.at(options.at(key, span), message, f"remove {sign}"))
            return None
        return self._with_default(Taken(source), place, options, span)

    def _number(self, source: Source, place: Place, options: Options, span: Span) -> Taken | None:
        scaling = self._scalings.of(source, place, options, span)
        if scaling is None:
            return None
        target = place.type.name
        if not options.narrow and (why := numeric_ranges.loss(source, scaling, target)):
            message = f"{place.shown} cannot hold every value exactly: {source.dotted!r} {why}"
            help = (
                f"write `{{from: {source.dotted}, narrow: true}}` to allow it; values are then rounded, "
                "and a datagram with a value outside of the range is dropped"
            )
            self._report(standard_rules.LossyNarrowing.at(span, message, help))
            return None
        rounded = not numeric_ranges.is_float(target) and not (source.is_integer and scaling.is_whole)
        return self._with_default(Taken(source, scaling, rounded), place, options, span)

    def _with_default(self, taken: Taken, place: Place, options: Options, span: Span) -> Taken | None:
        source = taken.source
        if not source.optional:
            return taken
        if "default" not in options.forms:
            message = f"{source.dotted!r} may be absent, but no `default` gives the value of {place.shown} in this case"
            self._report(
                standard_rules.AbsenceUnsaid.at(
                    span, message, "add a default: `{from: " + source.dotted + ", default: 0}`"
                )
            )
            return None
        default = self._value(place, options.forms["default"])
        return None if default is None else dataclasses.replace(taken, default=default)

    # --- constants ---

    def constant(self, place: Place, form: Form, negated: bool = False) -> Constant | None:
        """Return the constant that the table gives for a field of a standard message.

        If the field cannot hold the constant, this is reported, and the result is None.
        """
        if form.items is None:
            if place.type.is_many:
                message = f"{place.shown} is a {place.type}, so a single value does not fit; write a list"
                self._report(standard_rules.MappingDoesNotFit.at(form.span, message))
                return None
            return self._value(place, form, negated)
        count, length, bound = len(form.items), place.type.length, place.type.bound
        if not place.type.is_many or length not in (None, count) or (bound is not None and count > bound):
            message = f"{place.shown} is a {place.type}, but the constant has {count} items"
            self._report(standard_rules.MappingDoesNotFit.at(form.span, message))
            return None
        items = [self._value(place, item) for item in form.items]
        values = [value for item in items if item is not None and not isinstance(value := item.value, tuple)]
        return Constant(tuple(values)) if len(values) == len(items) else None

    def _value(self, place: Place, form: Form, negated: bool = False) -> Constant | None:
        """Return a value of the table, converted to the type of a field of a standard message.

        The value may be the name of a constant that the message declares. A value that does not fit is reported, and
        the result is None.
        """
        type, value = place.type.name, form.value
        if isinstance(value, str) and type == "string":
            return Constant(value)
        if isinstance(value, bool) and type == "bool":
            return Constant(value)
        if isinstance(value, str) and _is_number(type):
            return self._constant_of(place, value, form.span)
        if isinstance(value, (int, float, Fraction)) and not isinstance(value, bool) and _is_number(type):
            number = numeric_ranges.constant(-value if negated else value, type)
            if number is not None:
                return Constant(number)
        shown = _shown(value)
        message = f"the value {shown} does not fit {place.shown}, which is a {type}"
        self._report(standard_rules.MappingDoesNotFit.at(form.span, message, f"write a value of the type {type}"))
        return None

    def _constant_of(self, place: Place, name: str, span: Span) -> Constant | None:
        holder = self._definition(place.holders[-1])
        constants = {constant.name: constant.value for constant in holder.constants}
        if name in constants:
            return Constant(constants[name], name, holder.name)
        help = nearest(name, constants, f"known constants: {', '.join(constants) or 'none'}")
        self._report(standard_rules.UnknownEnumValue.at(span, f"{short(holder.name)} has no constant {name!r}", help))
        return None

    # --- enums ---

    def chosen(self, place: Place, path: str, form: Form, options: Options) -> Chosen | None:
        """Return the expression that gives a constant for each value of an enum field of the payload.

        ``path`` is the path of this field, and ``form`` is the row's `enum` entry. Enum values without a constant are
        reported. The result is None if the field is not a single enum value.
        """
        source, span = self._sources.find(path, form.span), form.span
        if source is None or place.type.is_many or not source.enum or source.repeated:
            if source is not None:
                message = (
                    f"`enum` converts a single enum value, but {source.dotted!r} or {place.shown} has another type"
                )
                self._report(standard_rules.MappingDoesNotFit.at(span, message, "remove `enum`"))
            return None
        declared, cases = self._sources.values_of(source.enum), []
        for name, entry in (form.entries or {}).items():
            counterpart = self._value(place, entry)
            if name not in declared:
                help = nearest(name, declared, f"known values: {', '.join(declared)}")
                message = f"{source.enum.name!r} has no value {name!r}"
                self._report(standard_rules.UnknownEnumValue.at(entry.span, message, help))
            elif counterpart is not None:
                cases.append(Case(declared[name], name, counterpart))
        default = self._value(place, options.forms["default"]) if "default" in options.forms else None
        numbers_given = {declared[name] for name in form.entries or {} if name in declared}
        missing = [name for name, number in declared.items() if number not in numbers_given]
        if not form.entries:
            self._report(
                standard_rules.EnumTableIncomplete.at(
                    span, f"`enum` of {place.shown} is empty, so no value of {source.dotted!r} can be converted"
                )
            )
        if missing and default is None:
            message = (
                f"`enum` of {place.shown} has no entry for {', '.join(map(repr, missing))} of {source.enum.name!r}"
            )
            self._report(
                standard_rules.EnumTableIncomplete.at(
                    span, message, "add the missing entries, or a `default` for all other values"
                )
            )
        return Chosen(source, tuple(sorted(cases, key=lambda case: case.number)), default)


def _is_number(type: str) -> bool:
    return type not in ("string", "wstring", "bool", "bytes") and "/" not in type


def _kind(type: str) -> str:
    return "number" if _is_number(type) else type


def _shown(value: object) -> str:
    if isinstance(value, Fraction):
        return str(value.numerator) if value.denominator == 1 else str(float(value))
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return repr(value)
