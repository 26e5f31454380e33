"""DDS types and qualities of service for ROS 2 messages.

A type has the real structure of its message, since Cyclone DDS compares structures where both sides announce one; but
samples are never built from it: what is written and taken are serialized bytes.
"""

from __future__ import annotations

from typing import Any

from cyclonedds.idl import IdlStruct, make_idl_struct, types
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Sequence, Text, fields_of, once_a_type
from roverlink.runtime.middleware.cyclone import WriterBatching

_MAX_BLOCKING = 0  # ns that a reliable write may wait for slow readers: a bridge that waited would lose datagrams
_UNLIMITED = -1
_KEPT_TO_READ = 256
"""Samples that a reader of ours keeps at least. The thread that takes them is one of several on few cores: it may be
left waiting for milliseconds, in which more than a topic's usual ten arrive. Nobody else sees this depth."""

_DDS_TYPES: dict[str, Any] = {
    "bool": bool,
    "byte": types.uint8,
    "char": types.uint8,
    "int8": types.int8,
    "uint8": types.uint8,
    "int16": types.int16,
    "uint16": types.uint16,
    "int32": types.int32,
    "uint32": types.uint32,
    "int64": types.int64,
    "uint64": types.uint64,
    "float32": types.float32,
    "float64": types.float64,
}


def dds_qos(qos: Qos, writing: bool, type_hash: str = "") -> DdsQos:
    """The DDS policies that ROS 2's own middlewares use for a quality of service, of a writer or of a reader.

    A type's hash goes where they look for it, into what an endpoint tells beside its policies.
    """
    reliable = qos.reliability == "reliable"
    latched = qos.durability == "transient_local"
    depth = qos.depth if writing else max(qos.depth, _KEPT_TO_READ)
    history: Any = Policy.History.KeepAll if qos.history == "keep_all" else Policy.History.KeepLast(depth)
    policies = [
        Policy.Reliability.Reliable(_MAX_BLOCKING) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        history,
        Policy.DataRepresentation(use_cdrv0_representation=True),
    ]
    if latched:
        # What is kept for those who come late has a history of its own.
        policies.append(Policy.DurabilityService(0, history, _UNLIMITED, _UNLIMITED, _UNLIMITED))
    if type_hash:
        policies.append(Policy.Userdata(f"typehash={type_hash};".encode()))
    if writing:
        policies += [Policy.WriterDataLifecycle(autodispose=False), WriterBatching()]
    return DdsQos(*policies)


# cyclonedds makes these by subscript, which its own stubs do not declare.
_sequence: Any = types.sequence.__class_getitem__
_array: Any = types.array.__class_getitem__
_bounded_text: Any = types.bounded_str.__class_getitem__


@once_a_type
def dds_type(message_type: type[Message]) -> type[IdlStruct]:
    """The DDS type of a ROS 2 message."""
    return make_idl_struct(*_declaration(message_type))


def _declaration(message_type: type[Message]) -> tuple[str, str, dict[str, Any]]:
    """Class name, DDS type name and fields of a message, as ROS 2's IDL has them."""
    package, kind, name = message_type.__msgtype__.split("/")
    fields = {field.name: _field_type(field.type) for field in fields_of(message_type)}
    return f"{name}_", f"{package}.{kind}.dds_.{name}_", fields or {"structure_needs_at_least_one_member": types.uint8}


def _field_type(field_type: FieldType) -> Any:
    if isinstance(field_type, Primitive):
        return _DDS_TYPES[field_type.name]
    if isinstance(field_type, Text):
        return str if field_type.bound is None else _bounded_text(field_type.bound)
    if isinstance(field_type, Sequence):
        element = _field_type(field_type.element)
        return _sequence(element) if field_type.bound is None else _sequence((element, field_type.bound))
    if isinstance(field_type, Array):
        return _array((_field_type(field_type.element), field_type.length))
    return dds_type(field_type)
