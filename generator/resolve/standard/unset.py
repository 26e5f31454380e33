"""All fields of a standard message with their expressions; a field that no entry of the table fills is reported.

A field may stay unfilled if its definition gives zero a meaning (a covariance of zero is unknown), or if the table
lists it under `unset`.
"""

from __future__ import annotations

from collections.abc import Callable

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.ir.interfaces import Constant, Expression, Interface, Parts, Path, TargetField, Unset
from roverlink.generator.resolve.interfaces import meanings
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.resolve.standard.filling import Filling
from roverlink.generator.resolve.standard.message_fields import Place
from roverlink.generator.table import StandardTopicSettings


class Tree:
    """Fields of a standard topic's message with their expressions, in the order of the message's definition."""

    def __init__(self, filling: Filling, settings: StandardTopicSettings, report: Callable[[Diagnostic], None]) -> None:
        self._filling, self._settings, self._report = filling, settings, report
        self._unset = {tuple(path.split(".")) for path in settings.unset}

    def fields(self) -> tuple[TargetField, ...]:
        """Return every field of the message with its expression. A field that must not stay unfilled is reported."""
        self._check_unset()
        root = self._filling.places.root
        return self._fields(root, (), (root.name,))

    def _check_unset(self) -> None:
        for path in sorted(self._unset):
            dotted = ".".join(path)
            span = self._settings.spans.get(f"unset.{dotted}", self._settings.span)
            self._filling.places.find(path, span)
            for filled in self._filling.expressions:
                if filled[: len(path)] == path or path[: len(filled)] == filled:
                    also = [(self._filling.spans[filled], f"'{'.'.join(filled)}' is filled here")]
                    self._report(
                        standard_rules.TargetFieldSetTwice.at(
                            span,
                            f"{dotted!r} is listed under `unset`, but also filled",
                            "keep only one of the two entries",
                            also,
                        )
                    )
                    break

    def _fields(self, interface: Interface, path: Path, holders: tuple[str, ...]) -> tuple[TargetField, ...]:
        return tuple(
            TargetField(field.name, field.type, self._value(Place((*path, field.name), field.type, holders)))
            for field in interface.fields
        )

    def _value(self, place: Place) -> Expression:
        expressions = self._filling.expressions
        if place.path in expressions:
            return expressions[place.path]
        if self._may_stay_unset(place):
            return Unset()
        if not place.type.is_message or place.type.is_many or not self._is_reached(place.path):
            message = f"{place.shown} is not filled, and subscribers would read its zero as a value"
            help = f"fill it with a proto field or a constant under `fields`, or list {place.dotted!r} under `unset`"
            span, rests_on = self._settings.at("fields"), self._filling.unplaced
            self._report(standard_rules.TargetFieldUnset.at(span, message, help, rests_on=rests_on))
            return Unset()
        nested = self._filling.places.definition(place.type.name)
        return Parts(self._fields(nested, place.path, (*place.holders, nested.name)))

    def _is_reached(self, path: Path) -> bool:
        """Return True if the table fills a field inside the field at a path, or lists such a field under `unset`."""
        named = (*self._filling.expressions, *self._unset)
        return any(other[: len(path)] == path and len(other) > len(path) for other in named)

    def _may_stay_unset(self, place: Place) -> bool:
        """Return True if a field may stay unfilled: zero has a meaning there, or the table lists it under `unset`."""
        if any(place.path[: len(path)] == path for path in self._unset):
            return True
        for depth, holder in enumerate(place.holders):
            path = ".".join(place.path[depth:])
            if path in meanings.ZERO_MEANS.get(holder, {}):
                return True
            other = meanings.ABSENT_WHERE_MINUS_ONE.get(holder, {}).get(path)
            if other and self._is_minus_one((*place.path[:depth], other)):
                return not self._is_reached(place.path)
        return False

    def _is_minus_one(self, path: Path) -> bool:
        value = self._filling.expressions.get(path)
        return isinstance(value, Constant) and isinstance(value.value, tuple) and value.value[:1] == (-1.0,)
