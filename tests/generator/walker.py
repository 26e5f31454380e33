"""The IR, walked field by field: which value of a payload belongs where in a ROS message."""

from __future__ import annotations

import json
from functools import reduce
from typing import Any

from google.protobuf.descriptor_pool import Default
from google.protobuf.json_format import MessageToDict
from google.protobuf.message import Message as Payload
from google.protobuf.message_factory import GetMessageClass
from random_payloads import fill, packed

from roverlink.generator.ir.model import AnyConversion, Bridge, Conversion, ConversionKind, FieldConversion


class RefusedError(Exception):
    """What the IR says must not be converted."""


class Walker:
    """Converts by the IR instead of by generated code."""

    def __init__(self, bridge: Bridge) -> None:
        self._conversions = bridge.conversions()
        self._anys = {conversion.ros: conversion for conversion in bridge.anys}
        self._messages = {message.name: message for message in bridge.messages}

    def message(self, conversion: Conversion, payload: Payload) -> dict[str, Any]:
        """The ROS message that a payload is, by field."""
        return {field.ros.name: self._taken(field, payload, conversion.ros) for field in conversion.fields}

    def _taken(self, field: FieldConversion, payload: Payload, ros: str) -> Any:
        *holders, name = field.proto_path
        holder = reduce(getattr, holders, payload)
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            return holder.HasField(name)
        if field.kind is ConversionKind.WHICH:
            named = {choice.proto: choice.constant for choice in field.choices}
            constant = named.get(holder.WhichOneof(name) or "")
            numbers = {constant.name: constant.value for constant in self._messages[ros].constants}
            return numbers[constant] if constant else 0
        value: Any = getattr(holder, name)
        if field.entry is not None:
            key, of_key = field.entry.value, field.entry.key
            return [{"key": self._one(of_key, one), "value": self._one(key, value[one])} for one in sorted(value)]
        if field.kind is ConversionKind.JSON and not field.repeated and not holder.HasField(name):
            return ""
        return [self._one(field, item) for item in value] if field.repeated else self._one(field, value)

    def _one(self, field: FieldConversion, value: Any) -> Any:
        if field.wrapping is not None:
            value = getattr(value, field.wrapping.field)
        if field.kind is ConversionKind.MESSAGE:
            if field.converter in self._anys:
                return self._any(self._anys[field.converter], value)
            return self.message(self._conversions[field.converter], value)
        if field.kind is ConversionKind.HELD:
            return {field.member: list(value) if isinstance(value, bytes) else value}
        if field.kind is ConversionKind.WELL_KNOWN:
            nanoseconds = value.seconds * 1_000_000_000 + value.nanos
            sec, nanosec = divmod(nanoseconds, 1_000_000_000)
            if not -(2**31) <= sec < 2**31:
                raise RefusedError
            return {"sec": sec, "nanosec": nanosec}
        if field.kind is ConversionKind.JSON:
            return json.dumps(_with_doubles(MessageToDict(value)), sort_keys=True, ensure_ascii=False)
        return value if isinstance(value, (str, int, float)) else list(value)

    def _any(self, conversion: AnyConversion, value: Any) -> dict[str, Any]:
        """The ROS message of an Any: of the members only the one that it holds says something."""
        made: dict[str, Any] = {"which": 0}
        constants = {constant.name: constant.value for constant in self._messages[conversion.ros].constants}
        for member in conversion.members:
            inner, held = (
                self._conversions[member.ros],
                GetMessageClass(Default().FindMessageTypeByName(member.proto))(),
            )
            if value.type_url.rpartition("/")[2] == member.proto and "/" in value.type_url:
                held.ParseFromString(value.value)
                made["which"] = constants[member.constant]
            made[member.field] = self.message(inner, held) if made["which"] == constants[member.constant] else None
        if not made["which"] and (value.type_url or value.value):
            raise RefusedError
        return made

    def settle(self, conversion: Conversion, payload: Payload) -> Payload:
        """What is left of a payload after it has been a ROS message.

        Fields that no ROS field takes are gone, and messages that cannot be absent in ROS are present.
        """
        settled = type(payload)()
        for field in conversion.fields:
            *holders, name = field.proto_path
            source, target = payload, settled
            for holder in holders:
                source, target = getattr(source, holder), getattr(target, holder)
                target.SetInParent()
            if field.kind not in (ConversionKind.PRESENCE, ConversionKind.WHICH) and _is_there(field, source):
                self._settle_field(field, getattr(source, name), target)
        return settled

    def _settle_field(self, field: FieldConversion, value: Any, target: Payload) -> None:
        name = field.proto_path[-1]
        if field.entry is not None:
            fill(getattr(target, name), {key: self._settled(field.entry.value, one) for key, one in value.items()})
        elif field.repeated:
            getattr(target, name).extend([self._settled(field, item) for item in value])
        elif isinstance(value, Payload):
            getattr(target, name).CopyFrom(self._settled(field, value))
            getattr(target, name).SetInParent()
        else:
            setattr(target, name, value)

    def _settled(self, field: FieldConversion, value: Any) -> Any:
        if field.converter in self._conversions:
            return self.settle(self._conversions[field.converter], value)
        for member in self._anys[field.converter].members if field.converter in self._anys else ():
            if value.type_url.rpartition("/")[2] == member.proto:
                held = GetMessageClass(Default().FindMessageTypeByName(member.proto)).FromString(value.value)
                return packed(self.settle(self._conversions[member.ros], held))
        return value


def _is_there(field: FieldConversion, holder: Payload) -> bool:
    """Whether a field is set in the payload that comes back."""
    name = field.proto_path[-1]
    if field.repeated:
        return True
    says = field.presence or field.which or field.kind in (ConversionKind.EMPTY, ConversionKind.JSON)
    return not says or holder.HasField(name)


def _with_doubles(said: Any) -> Any:
    """What protobuf's own JSON says, with the numbers that it shortens."""
    if isinstance(said, dict):
        return {key: _with_doubles(value) for key, value in said.items()}
    if isinstance(said, list):
        return [_with_doubles(value) for value in said]
    return float(said) if isinstance(said, int) and not isinstance(said, bool) else said
