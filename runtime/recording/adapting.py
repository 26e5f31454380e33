"""Conversion of recorded datagrams to the schema of the current table ("today"), for recordings with an older schema.

A row is identified by its number, as on the wire.

- If number, name and all fields of a payload are unchanged, the bytes of the datagram stay unchanged.
- If a payload or a field has another number or type today, its values are copied by name.
- If a number belongs to another payload today, the datagram is refused, because its bytes would be misread.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from google.protobuf.message import DecodeError

from roverlink.runtime.core import envelope
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.protobuf_versions import is_repeated
from roverlink.runtime.core.registry import Registry

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


class Adapter:
    """Converter of recorded datagrams to datagrams with the envelope of the current table, for a replay."""

    def __init__(self, recorded: type[ProtoMessage], registry: Registry) -> None:
        self._recorded, self._registry = recorded, registry
        today = registry.envelope.DESCRIPTOR
        self._same = {
            field.number
            for field in recorded.DESCRIPTOR.fields
            if field.number in today.fields_by_number and same_meaning(field, today.fields_by_number[field.number])
        }
        rest = [field for field in recorded.DESCRIPTOR.fields if field.number not in self._same]
        self._moved = {field.number: moved for field in rest if (moved := _counterpart(field, today)) is not None}
        self.refused = {field.number: self._reason(field) for field in rest if field.number not in self._moved}
        """Reason why a recorded payload is not replayed, by its number in the recording."""
        self.changed = sorted(f"{field.name} ({field.number})" for field in rest if field.number in self._moved)
        """Recorded payloads whose field values are copied by name, because numbers or types have changed since."""

    def number_today(self, number: int) -> int:
        """Return the number of a recorded payload in the current table; a refused payload keeps its recorded number."""
        moved = self._moved.get(number)
        return number if moved is None else int(moved.number)

    def adapt(self, datagram: bytes) -> bytes:
        """Convert a recorded datagram to the current schema. Payloads whose meaning is unchanged keep their bytes.

        Raises `DatagramError` if the current table uses the payload's number for another payload, or not at all.
        """
        numbers = envelope.payload_numbers(envelope.restore(datagram))
        # The last member of the oneof wins, as in `Translator`.
        if not numbers or numbers[-1] in self._same or numbers[-1] not in self._recorded.DESCRIPTOR.fields_by_number:
            return datagram  # not understood in the recording either: keep the bytes
        if numbers[-1] in self.refused:
            raise DatagramError(Reason.UNKNOWN_PAYLOAD, self.refused[numbers[-1]])
        try:
            then = self._recorded.FromString(envelope.restore(datagram))
        except DecodeError:
            return datagram
        field = self._recorded.DESCRIPTOR.fields_by_number[numbers[-1]]
        now = self._registry.envelope()
        _copy_by_name(getattr(then, field.name), getattr(now, self._moved[numbers[-1]].name))
        return now.SerializeToString()

    def _reason(self, field: Any) -> str:
        today = self._registry.envelope.DESCRIPTOR.fields_by_number.get(field.number)
        if today is not None:
            was, now = _spelled(field), _spelled(today)
            return f"number {field.number} was {was} in the recording, and is {now} in the present table"
        retired = self._registry.retired.get(field.number)
        gone = "is retired" if retired else "does not exist"
        return f"number {field.number}, {_spelled(field)} in the recording, {gone} in the present table"


def _spelled(field: Any) -> str:
    return f"{field.name!r} ({field.message_type.name if field.message_type else 'no message'})"


def _counterpart(field: Any, today: Any) -> Any | None:
    """Return the field of ``today``, the current envelope, that has the name and message name of a recorded field.

    Returns None if there is no such field.
    """
    found = today.fields_by_name.get(field.name)
    if found is None or found.message_type is None or field.message_type is None:
        return None
    return found if found.message_type.name == field.message_type.name else None


def same_meaning(then: Any, now: Any) -> bool:
    """Return true if the bytes of a field mean the same in both schemas.

    Fields that were added to its message later do not matter. ``then`` is the field's descriptor in the older schema,
    ``now`` its descriptor in the newer one.
    """
    if (is_repeated(then), then.type) != (is_repeated(now), now.type):
        return False
    if then.message_type is None or now.message_type is None:
        return bool(then.name == now.name)
    # A member that was renamed is the same payload if its message is; so is a message that was renamed.
    if then.name != now.name and then.message_type.name != now.message_type.name:
        return False
    return _same_message(then.message_type, now.message_type, frozenset())


def _same_message(then: Any, now: Any, above: frozenset[str]) -> bool:
    if then.full_name in above:  # a recursive message: it is being compared already
        return True
    above |= {then.full_name}
    return all(
        field.number in now.fields_by_number
        and _same_field(field, now.fields_by_number[field.number], then, now, above)
        for field in then.fields
    )


def _same_field(then: Any, now: Any, then_of: Any, now_of: Any, above: frozenset[str]) -> bool:
    if (is_repeated(then), then.type) != (is_repeated(now), now.type):
        return False
    if then.name != now.name and (then.name in now_of.fields_by_name or now.name in then_of.fields_by_name):
        return False  # both names exist in both schemas: two fields were swapped, none was renamed
    return then.message_type is None or _same_message(then.message_type, now.message_type, above)


def _copy_by_name(then: Any, now: Any) -> None:
    """Copy the fields of the recorded message ``then`` to the fields of ``now`` with the same names.

    A value that does not fit the current type of its field is left out.
    """
    # An empty message is still present: a payload without fields selects its oneof member.
    now.SetInParent()
    for field, value in then.ListFields():
        target = now.DESCRIPTOR.fields_by_name.get(field.name)
        if target is None or is_repeated(target) != is_repeated(field):
            continue
        if (target.message_type is None) != (field.message_type is None):
            continue
        _copy_field(value, now, target)


def _copy_field(value: Any, now: Any, target: Any) -> None:
    if target.message_type is None:
        with contextlib.suppress(TypeError, ValueError):  # the value does not fit: the field keeps its default
            if is_repeated(target):
                getattr(now, target.name).extend(value)
            else:
                setattr(now, target.name, value)
    elif is_repeated(target):
        for element in value:
            _copy_by_name(element, getattr(now, target.name).add())
    else:
        _copy_by_name(value, getattr(now, target.name))
