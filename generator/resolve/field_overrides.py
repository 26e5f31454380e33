"""Overrides for single proto fields: the exceptions that rows list under `presence` and `any`.

An override has a path such as ``pose.stamp``, which leads through nested messages, lists and maps to a proto field. A
proto message becomes one ROS message, so an override applies in all rows that use the message.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar, cast

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.resolve import well_known
from roverlink.generator.resolve.conversion_rules import (
    ContradictingPaths,
    RowsDisagreeOnAMessage,
    SettingWithoutEffect,
    UnknownField,
)
from roverlink.generator.table import Row, Table
from roverlink.suggestions import nearest

T = TypeVar("T")

Key = tuple[str, str]
"""Full name of a proto message, and the name of one of its fields: ``("rover.Imu", "stamp")``."""


class FieldSettings:
    """Overrides that all rows list under `presence` and `any`.

    The overrides are stored by the full name of the proto message and the name of its field.
    """

    def __init__(self, table: Table, schema: Schema, report: Callable[[Diagnostic], None]) -> None:
        self._schema, self._report = schema, report
        rows = [row for row in table.rows if row.proto in schema.messages]
        self.presence = self._collected("presence", ((row, row.presence) for row in rows), self._no_presence)
        self.anys = self._collected("any", ((row, row.anys) for row in rows), self._no_any)

    def _collected(
        self, group: str, rows: Iterator[tuple[Row, Mapping[str, T]]], obstacle: Callable[[ProtoField, T], str]
    ) -> dict[Key, T]:
        """Return the overrides that the rows list under the key ``group``, `presence` or `any`; mistakes are reported.

        ``rows`` has each row with its overrides, by the path of the proto field. ``obstacle`` is a function that
        returns the reason why an override does not apply to a field, or an empty text.
        """
        settings: dict[Key, T] = {}
        first_rows: dict[Key, Row] = {}
        for row, paths in rows:
            for path, value in paths.items():
                span = row.at(f"{group}.{path}")
                if row.standard:
                    self._report(SettingWithoutEffect.at(span, *without_effect_on_standard(group, row)))
                    continue
                found = self._field(row, group, path)
                if found is None:
                    continue
                key, field = found
                if why := obstacle(field, value):
                    fault = f"`{group}` has no effect on {path!r}, which {why}"
                    self._report(SettingWithoutEffect.at(span, fault, f"remove {path!r} from `{group}`"))
                elif settings.setdefault(key, value) != value:
                    other = first_rows[key]
                    message = (
                        f"`{group}` of the field '{'.'.join(key)}' is {_shown(value)} here, "
                        f"but {_shown(settings[key])} in the row {other.name!r}, which contains the field too"
                    )
                    help = f"write the same value in both rows; {key[0]!r} becomes only one ROS message"
                    self._report(
                        RowsDisagreeOnAMessage.at(span, message, help, [(other.span, f"the row {other.name!r}")])
                    )
                first_rows.setdefault(key, row)
        return settings

    def _field(self, row: Row, group: str, path: str) -> tuple[Key, ProtoField] | None:
        """Return the proto field to which a row's path leads, with its `Key`.

        A path that leads to no field is reported, and the result is None.
        """
        for whole in itertools.accumulate(path.split("."), "{}.{}".format):
            if whole in row.ignore:
                fault = f"{path!r} is listed under `{group}`, but {whole!r} is ignored"
                self._report(
                    ContradictingPaths.at(row.at(f"{group}.{path}"), fault, "keep only one of the two settings")
                )
                return None
        message: ProtoMessage | None = self._schema.messages[row.proto]
        *holders, name = path.split(".")
        for part in holders:
            message = self._held(message, part)
        field = _field_of(message, name)
        if message is None or field is None:
            known = [] if message is None else [field.name for field in message.fields]
            fault = f"the proto message {row.proto!r} has no field {path!r}"
            help = nearest(
                name, known, f"known fields: {', '.join(known)}" if known else f"remove {path!r} from `{group}`"
            )
            self._report(UnknownField.at(row.at(f"{group}.{path}"), fault, help))
            return None
        return (message.full_name, name), field

    def _held(self, message: ProtoMessage | None, name: str) -> ProtoMessage | None:
        """Return the message that is the type of the field ``name``; for a map, the type of its values.

        The result is None if there is no such field, or if its type is not a message.
        """
        field = _field_of(message, name)
        held = self._schema.messages.get(field.type_name) if field else None
        return self._held(held, "value") if held and held.map_entry else held

    def _no_presence(self, field: ProtoField, keep: bool) -> str:
        """Return the reason why `presence` has no effect on a field; empty if it has an effect.

        The reason continues a sentence about the field: ``is required, so it is never absent``. ``keep`` is the row's
        setting: True if the ROS message shall have a field ``has_<field>``.
        """
        if field.repeated:
            return "is repeated, so it can be empty but not absent"
        if field.oneof:
            return f"belongs to the oneof {field.oneof!r}, whose `which_` field already tells which member is set"
        if field.label == "required":
            return "is required, so it is never absent"
        if field.type_name in well_known.TEXTS:
            return "becomes a text, which is empty if the field is absent"
        if field.type_name == well_known.EMPTY and not keep:
            return "has no content except its presence"
        if field.label != "optional":
            return "does not distinguish absent from zero, because it is not `optional`"
        return ""

    def _no_any(self, field: ProtoField, _: object) -> str:
        """Return the reason why `any` has no effect on a field; empty if it has an effect.

        It has an effect on a google.protobuf.Any, and on a map whose values are of this type.
        """
        held = self._schema.messages.get(field.type_name)
        if held is not None and held.map_entry:
            field = held.fields[1]
        return "" if field.type_name == well_known.ANY else "is not a google.protobuf.Any"


def without_effect_on_standard(key: str, row: Row) -> tuple[str, str]:
    """Return the message and the help line of the diagnostic for a key of a row that has a standard message.

    A key such as `presence` changes generated ROS messages. It has no effect on a standard message such as
    ``sensor_msgs/Imu``.
    """
    message = f"`{key}` has no effect, because {row.ros!r} is a standard message"
    return message, f"remove `{key}`, or give the row a message of your own package"


def _field_of(message: ProtoMessage | None, name: str) -> ProtoField | None:
    return next((field for field in message.fields if field.name == name), None) if message else None


def _shown(value: object) -> str:
    """Return a value of `presence` or `any` as mapping.yaml spells it: ``true``, or ``[Drill, Arm]``."""
    return str(value).lower() if isinstance(value, bool) else f"[{', '.join(cast('Iterable[str]', value))}]"
