"""The hash of a row says whether two ends read its bytes in the same way, and says nothing else."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from random import Random

import pytest
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumValueDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
    SourceCodeInfo,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.row_hash import row_hash

_SCALARS = [
    kind
    for kind in FieldDescriptorProto.Type.values()
    if kind not in (FieldDescriptorProto.TYPE_MESSAGE, FieldDescriptorProto.TYPE_GROUP, FieldDescriptorProto.TYPE_ENUM)
]
_MESSAGES = ["Payload", "Inner", "Innermost", "Unrelated"]
_ENUMS = ["Mode", "UnrelatedMode"]
_REACHED = ["Payload", "Inner", "Innermost", "Mode"]


def _file(random: Random) -> FileDescriptorProto:
    """Make up a file in which Payload contains Inner, Inner contains Innermost, and Innermost contains Mode."""
    file = FileDescriptorProto(name="a.proto", package="p", syntax="proto3")
    holds = {"Payload": "Inner", "Inner": "Innermost"}
    for name in _MESSAGES:
        message = file.message_type.add(name=name)
        message.oneof_decl.add(name="choice")
        numbers = random.sample(range(1, 40), 5)
        for index, number in enumerate(numbers):
            field = message.field.add(name=f"f{index}", number=number, type=random.choice(_SCALARS))
            field.label = random.choice([FieldDescriptorProto.LABEL_OPTIONAL, FieldDescriptorProto.LABEL_REPEATED])
        for index, number in ((0, 50), (1, 51)):
            message.field.add(name=f"c{index}", number=number, type=5, label=1, oneof_index=0)
        if name in holds:
            message.field.add(name="held", number=60, type=11, label=1, type_name=f".p.{holds[name]}")
        if name == "Innermost":
            message.field.add(name="mode", number=60, type=14, label=1, type_name=".p.Mode")
    for name in _ENUMS:
        values = [0, *random.sample(range(1, 40), 3)]
        file.enum_type.add(name=name).value.extend(
            [_value(f"{name}_{number}", number) for number in values]  # C++ scope: the names differ between enums
        )
    return file


def _value(name: str, number: int) -> EnumValueDescriptorProto:
    return EnumValueDescriptorProto(name=name, number=number)


def _hash(*files: FileDescriptorProto) -> int:
    return row_hash(schema_of(FileDescriptorSet(file=files), ""), "p.Payload")


def _message(file: FileDescriptorProto, name: str) -> DescriptorProto:
    return next(message for message in file.message_type if message.name == name)


def _rename(random: Random, message: DescriptorProto) -> None:
    random.choice(message.field).name += "_new"


def _renumber(random: Random, message: DescriptorProto) -> None:
    random.choice(message.field).number += 100


def _retype(random: Random, message: DescriptorProto) -> None:
    field = message.field[random.randrange(5)]
    field.type = random.choice([kind for kind in _SCALARS if kind != field.type])


def _relabel(random: Random, message: DescriptorProto) -> None:
    field = message.field[random.randrange(5)]
    field.label = 3 if field.label == 1 else 1


def _add(random: Random, message: DescriptorProto) -> None:
    message.field.add(name="added", number=200, type=random.choice(_SCALARS), label=1)


def _remove(random: Random, message: DescriptorProto) -> None:
    del message.field[random.randrange(5)]


def _move_out_of_the_oneof(random: Random, message: DescriptorProto) -> None:
    message.field[random.choice([5, 6])].ClearField("oneof_index")


def _rename_oneof(_: Random, message: DescriptorProto) -> None:
    message.oneof_decl[0].name = "other"


_CHANGES = [_rename, _renumber, _retype, _relabel, _add, _remove, _move_out_of_the_oneof, _rename_oneof]
_EXAMPLES = settings(max_examples=8)


@pytest.mark.parametrize("change", _CHANGES, ids=lambda change: change.__name__.strip("_"))
@pytest.mark.parametrize("name", _MESSAGES)
@_EXAMPLES
@given(random=st.randoms(use_true_random=False))
def test_every_change_of_a_message_in_the_payload_changes_the_hash(
    name: str, change: Callable[[Random, DescriptorProto], None], random: Random
) -> None:
    """Another number, name, type, label or oneof, one field more or less: the hash differs if the payload has it."""
    file = _file(random)
    before = _hash(file)
    change(random, _message(file, name))
    assert (_hash(file) != before) == (name in _REACHED)


@pytest.mark.parametrize("name", _ENUMS)
@pytest.mark.parametrize("change", ["name", "number", "add", "remove"])
@_EXAMPLES
@given(random=st.randoms(use_true_random=False))
def test_every_change_of_an_enum_in_the_payload_changes_the_hash(name: str, change: str, random: Random) -> None:
    """A value that is renamed, renumbered, added or removed changes the hash if the payload has the enum."""
    file = _file(random)
    before = _hash(file)
    enum = next(enum for enum in file.enum_type if enum.name == name)
    if change == "name":
        enum.value[1].name += "_new"
    elif change == "number":
        enum.value[1].number += 100
    elif change == "add":
        enum.value.append(_value("ADDED", 200))
    else:
        del enum.value[1]
    assert (_hash(file) != before) == (name in _REACHED)


@_EXAMPLES
@given(random=st.randoms(use_true_random=False))
def test_nothing_else_changes_the_hash(random: Random) -> None:
    """The order of declarations, their files, comments, reserved numbers and other messages leave the hash alone."""
    file = _file(random)
    before = _hash(file)
    moved = FileDescriptorProto(name="elsewhere/b.proto", package="p", syntax="proto3")
    for message in random.sample(list(file.message_type), 4):
        copy = (moved if random.random() < 0.5 else file).message_type.add()
        copy.CopyFrom(message)
        file.message_type.remove(message)
        fields = random.sample(list(copy.field), len(copy.field))
        del copy.field[:]
        copy.field.extend(fields)
        copy.reserved_range.add(start=300, end=310)
        copy.reserved_name.append("gone")
        copy.options.deprecated = random.random() < 0.5
    for enum in file.enum_type:
        values = random.sample(list(enum.value), len(enum.value))
        del enum.value[:]
        enum.value.extend(values)
    file.source_code_info.CopyFrom(
        SourceCodeInfo(
            location=[SourceCodeInfo.Location(path=[4, 0], span=[1, 0, 1], leading_comments=str(random.random()))]
        )
    )
    file.message_type.add(name="New").field.add(name="x", number=1, type=1, label=1)
    assert _hash(*random.sample([file, moved], 2)) == before


def test_two_payloads_that_contain_each_other_have_different_hashes() -> None:
    """The hash is that of one payload, also where two payloads reach the same messages."""
    file = FileDescriptorProto(name="a.proto", package="p", syntax="proto3")
    for name, other in (("Payload", "Other"), ("Other", "Payload")):
        file.message_type.add(name=name).field.add(name="x", number=1, type=11, label=1, type_name=f".p.{other}")
    schema = schema_of(FileDescriptorSet(file=[file]), "")
    assert row_hash(schema, "p.Payload") != row_hash(schema, "p.Other")


def test_the_hash_is_that_of_the_documented_text() -> None:
    """A program without roverlink can compute the hash from the text that the module documents."""
    file = FileDescriptorProto(name="a.proto", package="p", syntax="proto2")
    payload = file.message_type.add(name="Payload")
    payload.oneof_decl.add(name="choice")
    payload.field.add(name="mode", number=3, type=14, label=1, type_name=".p.Mode")
    payload.field.add(name="speed", number=1, type=2, label=2)
    payload.field.add(name="parts", number=2, type=11, label=3, type_name=".p.Part")
    payload.field.add(name="count", number=4, type=13, label=1, oneof_index=0)
    payload.field.add(name="level", number=5, type=5, label=1, default_value="7")
    file.message_type.add(name="Part")
    file.enum_type.add(name="Mode").value.extend([_value("IDLE", 0), _value("DRIVE", -1)])
    text = (
        "p.Payload\nmessage p.Part\nmessage p.Payload\n1 speed float required\n2 parts p.Part repeated\n"
        '3 mode p.Mode optional\n4 count uint32 in choice\n5 level int32 optional default="7"\n'
        "enum p.Mode\n-1 DRIVE\n0 IDLE\n"
    )
    assert _hash(file) == int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")
