"""Expressions for single fields: a field of the payload, a constant, or a choice by an enum."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.ir.interfaces import Case, Chosen, Constant, Interface, Source, Taken
from roverlink.generator.resolve.standard import numeric_ranges, standard_rules
from roverlink.generator.resolve.standard.field_options import Options, Scalings
from roverlink.generator.resolve.standard.message_fields import Place, short
from roverlink.generator.resolve.standard.payload_fields import Sources
from roverlink.generator.table import Form


class Leaves:
    """Maker of expressions for fields that are not messages. It reports mistakes."""

    def __init__(
        self, sources: Sources, definition: Callable[[str], Interface], report: Callable[[Diagnostic], None]
    ) -> None:
        self._sources, self._definition, self._report = sources, definition, report
        self._scalings = Scalings(report)

    # --- fields of the payload ---

    def taken(self, place: Place, text: str, options: Options, span: Span) -> Taken | Chosen | None:
        """Return the expression for a path into the payload; a - before the path negates the value."""
        source = self._sources.find(text.removeprefix("-"), span)
        if source is None:
            return None
        options = options.signed(text.startswith("-"))
        if source.enum:
            help = f"list the result of each value under `enum`: {{{', '.join(self._sources.values_of(source.enum))}}}"
            message = f"{source.dotted!r} is an enum, whose numbers have no meaning in {place.shown}"
            self._report(standard_rules.WRONG_FORM.at(span, message, help))
            return None
        if why := self._misfit(source, place):
            self._report(standard_rules.WRONG_FORM.at(span, why))
            return None
        if not _is_number(source.type):
            return self._unscaled(source, place, options, span)
        return self._number(source, place, options, span)

    def _misfit(self, source: Source, place: Place) -> str:
        """Return the reason why a field does not fit without options; empty if it fits."""
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
            message = f"{source.dotted!r} is a {source.type}, which has no {key or 'sign'}"
            self._report(standard_rules.WRONG_FORM.at(options.at(key, span), message))
            return None
        return self._with_default(Taken(source), place, options, span)

    def _number(self, source: Source, place: Place, options: Options, span: Span) -> Taken | None:
        scaling = self._scalings.of(source, place, options, span)
        if scaling is None:
            return None
        target = place.type.name
        if not options.narrow and (why := numeric_ranges.loss(source, scaling, target)):
            message = f"{source.dotted!r} {why}, in {place.shown}"
            help = "`narrow: true` allows it; a datagram whose value does not fit is then dropped"
            self._report(standard_rules.NARROWING.at(span, message, help))
            return None
        rounded = not numeric_ranges.is_float(target) and not (source.is_integer and scaling.is_whole)
        return self._with_default(Taken(source, scaling, rounded), place, options, span)

    def _with_default(self, taken: Taken, place: Place, options: Options, span: Span) -> Taken | None:
        source = taken.source
        if not source.optional:
            return taken
        if "default" not in options.forms:
            message = f"{source.dotted!r} may be absent, but no value is given for {place.shown} in this case"
            self._report(
                standard_rules.ABSENCE_UNSAID.at(
                    span, message, "add a default: `{from: " + source.dotted + ", default: 0}`"
                )
            )
            return None
        default = self._value(place, options.forms["default"])
        return None if default is None else Taken(source, taken.scaling, taken.rounded, default.value)

    # --- constants ---

    def constant(self, place: Place, form: Form, negated: bool = False) -> Constant | None:
        """Return a constant of the table; report it and return None if the field cannot hold it."""
        if form.items is None:
            case = None if place.type.is_many else self._value(place, form, negated)
            if place.type.is_many:
                message = f"{place.shown} is a {place.type}, so a single value does not fit; write a list"
                self._report(standard_rules.WRONG_FORM.at(form.span, message))
            return None if case is None else Constant(case.value)
        length, bound = place.type.length, place.type.bound
        if not place.type.is_many or len(form.items) != (len(form.items) if length is None else length):
            message = f"{place.shown} is a {place.type}, but the constant has {len(form.items)} items"
            self._report(standard_rules.WRONG_FORM.at(form.span, message))
            return None
        if bound is not None and len(form.items) > bound:
            message = f"{place.shown} is a {place.type}, but the constant has {len(form.items)} items"
            self._report(standard_rules.WRONG_FORM.at(form.span, message))
            return None
        values = [self._value(place, item) for item in form.items]
        return None if None in values else Constant(tuple(case.value for case in values if case is not None))

    def _value(self, place: Place, form: Form, negated: bool = False) -> Case | None:
        """Return a value in the field's type; the name of a constant of its message is a value, too."""
        type, value = place.type.name, form.value
        if isinstance(value, str) and type == "string":
            return Case(0, "", value, "")
        if isinstance(value, bool) and type == "bool":
            return Case(0, "", value, "")
        if isinstance(value, str) and _is_number(type):
            return self._constant_of(place, value, form.span)
        if isinstance(value, (int, float, Fraction)) and not isinstance(value, bool) and _is_number(type):
            number = numeric_ranges.constant(-value if negated else value, type)
            if number is not None:
                return Case(0, "", number, "")
        shown = _shown(value)
        self._report(standard_rules.WRONG_FORM.at(form.span, f"{shown} does not fit {place.shown}, a {type}"))
        return None

    def _constant_of(self, place: Place, name: str, span: Span) -> Case | None:
        holder = self._definition(place.holders[-1])
        constants = {constant.name: constant.value for constant in holder.constants}
        if name in constants:
            return Case(0, "", constants[name], name)
        help = nearest(name, constants, f"known constants: {', '.join(constants) or 'none'}")
        self._report(standard_rules.UNKNOWN_VALUE.at(span, f"{short(holder.name)} has no constant {name!r}", help))
        return None

    # --- enums ---

    def chosen(self, place: Place, path: str, form: Form, options: Options) -> Chosen | None:
        """Return the expression that maps an enum's values to constants; report declared values without an entry."""
        source, span = self._sources.find(path, form.span), form.span
        if source is None or place.type.is_many or not source.enum or source.repeated:
            if source is not None:
                message = (
                    f"`enum` converts a single enum value, but {source.dotted!r} or {place.shown} is something else"
                )
                self._report(standard_rules.WRONG_FORM.at(span, message, "remove `enum`"))
            return None
        declared, cases = self._sources.values_of(source.enum), []
        for name, entry in (form.entries or {}).items():
            case = self._value(place, entry)
            if name not in declared:
                help = nearest(name, declared, f"known values: {', '.join(declared)}")
                self._report(
                    standard_rules.UNKNOWN_VALUE.at(entry.span, f"{source.enum!r} has no value {name!r}", help)
                )
            elif case is not None:
                cases.append(Case(declared[name], name, case.value, case.constant))
        default = self._value(place, options.forms["default"]) if "default" in options.forms else None
        numbers_given = {declared[name] for name in form.entries or {} if name in declared}
        missing = [name for name, number in declared.items() if number not in numbers_given]
        if not form.entries:
            self._report(
                standard_rules.ENUM_TABLE.at(
                    span, f"`enum` of {place.shown} is empty, so {source.dotted!r} has no meaning"
                )
            )
        if missing and default is None:
            message = f"`enum` of {place.shown} has no entry for {', '.join(map(repr, missing))} of {source.enum!r}"
            self._report(
                standard_rules.ENUM_TABLE.at(
                    span, message, "add the missing entries, or a `default` for all other values"
                )
            )
        return Chosen(source, tuple(sorted(cases, key=lambda case: case.number)), place.holders[-1], default)


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
