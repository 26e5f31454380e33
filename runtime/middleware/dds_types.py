"""DDS types and DDS QoS policies for ROS 2 messages.

A DDS type has the same structure as its message, because Cyclone DDS compares the structures if both sides announce
them. But no object of the type is ever created: we write and take serialized bytes. So all that Cyclone DDS needs is a
description of each type. Its compiler of types is slow, so that the descriptions stay in the user's cache folder.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

from cyclonedds.idl import IdlStruct, make_idl_struct, types
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import (
    Array,
    FieldType,
    Message,
    Primitive,
    Sequence,
    Text,
    cached_by_type,
    fields_of,
    messages_in,
)
from roverlink.runtime.middleware.cyclone import COMPILER, DescribedType, WriterBatching, describe
from roverlink.runtime.middleware.dds_names import dds_type_name
from roverlink.runtime.middleware.serving import KEPT_TO_READ
from roverlink.user_cache import CacheFile

_MAX_BLOCKING = 0  # ns that a reliable write may block for slow readers; a blocked bridge loses datagrams
_UNLIMITED = -1

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


def dds_qos(qos: Qos, writing: bool, type_hash: str = "", exact_depth: bool = False) -> DdsQos:
    """Return the DDS policies that the ROS 2 middlewares use for a QoS profile.

    ``writing`` is true for a writer, false for a reader. The type hash of the message is put into the USER_DATA of the
    writer or reader; ROS 2 looks for it there since the distribution Iron. With ``exact_depth``, a reader keeps no more
    samples than the depth of the profile.
    """
    reliable = qos.reliability == "reliable"
    latched = qos.durability == "transient_local"
    # Cyclone DDS announces the larger depth to other nodes, too: the resource limits can only lower the number of
    # samples that it keeps, and DDS forbids changing the depth of an existing reader.
    depth = qos.depth if writing or exact_depth else max(qos.depth, KEPT_TO_READ)
    history: Any = Policy.History.KeepAll if qos.history == "keep_all" else Policy.History.KeepLast(depth)
    policies = [
        Policy.Reliability.Reliable(_MAX_BLOCKING) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        history,
        # XCDR1. ROS 2 does not match an endpoint that offers XCDR2 only, the default for appendable types.
        Policy.DataRepresentation(use_cdrv0_representation=True),
    ]
    if latched:
        # The samples kept for late subscribers have their own history policy.
        policies.append(Policy.DurabilityService(0, history, _UNLIMITED, _UNLIMITED, _UNLIMITED))
    if type_hash:
        policies.append(Policy.Userdata(f"typehash={type_hash};".encode()))
    if writing:
        # The ROS 2 middlewares set autodispose to false: a publisher that leaves must not dispose its instance.
        policies += [Policy.WriterDataLifecycle(autodispose=False), WriterBatching()]
    return DdsQos(*policies)


# cyclonedds makes these by subscript, which its own stubs do not declare.
_sequence: Any = types.sequence.__class_getitem__
_array: Any = types.array.__class_getitem__
_bounded_text: Any = types.bounded_str.__class_getitem__


@cached_by_type
def dds_type(message_type: type[Message]) -> type[DescribedType]:
    """Return the DDS type of a ROS 2 message for a topic: ``comms/msg/Imu`` -> ``comms::msg::dds_::Imu_``."""
    parts = [(one.__msgtype__, fields_of(one)) for one in (message_type, *messages_in(message_type))]
    structure = hashlib.sha256(repr(parts).encode()).hexdigest()
    file = CacheFile("dds-types", Path("/", structure), _version())
    description = file.load()
    if description is None:
        description = describe(idl_struct(message_type))
        file.save(description)
    return DescribedType.of(description)


@cache
def _version() -> bytes:
    """Return what changes with this module, or if another version of Cyclone DDS is installed."""
    compiler = COMPILER.stat()
    return f"{compiler.st_size} {compiler.st_mtime_ns} ".encode() + Path(__file__).read_bytes()


@cached_by_type
def idl_struct(message_type: type[Message]) -> type[IdlStruct]:
    """Return the DDS type of a ROS 2 message as a class of the package cyclonedds."""
    return make_idl_struct(*_declaration(message_type))


def _declaration(message_type: type[Message]) -> tuple[str, str, dict[str, Any]]:
    """Return the class name, DDS type name and fields of a message's DDS type, following ROS 2's IDL."""
    name = dds_type_name(message_type.__msgtype__).replace("::", ".")
    fields = {field.name: _field_type(field.type) for field in fields_of(message_type)}
    return name.rpartition(".")[2], name, fields or {"structure_needs_at_least_one_member": types.uint8}


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
    return idl_struct(field_type)
