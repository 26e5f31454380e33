"""Does the generated code of a project do what the table says? A script.

Each line that it reads says how many examples to make up for each handler, and of which project.
For each it prints how the check ended: 0, or 1 with what is wrong in ``crosscheck.log`` in the project's folder. It
generates, loads the generated code, and checks each handler with random payloads against two others that know nothing
of that code: the IR, walked field by field by `walker`, says which value belongs where, and the `rosbags` package, fed
with the generated .msg files, says which bytes those are.

Each project has a process of its own, because two projects have each a package `generated`, and because protobuf
registers message types once a process. That is a fork of this one, which has loaded what they share: loading it takes
longer than most checks.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import Any, NoReturn

import pytest
from google.protobuf.message import Message as Payload
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from native_crosscheck import NativeCheck
from random_payloads import Payloads
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from standard_crosscheck import check_standard_topics
from walker import RefusedError, Walker

from roverlink.generator.emit.writer import compare, write
from roverlink.generator.ir.model import Conversion, ConversionKind
from roverlink.generator.pipeline import compile_table
from roverlink.runtime import ConversionError, load_registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import fields_of

_PLACEHOLDER = "structure_needs_at_least_one_member"  # what ROS 2 puts into a message without fields

# --- rosbags ----------------------------------------------------------------------------------------------------


def typestore(generated: Path, package: str) -> Typestore:
    """A rosbags store that has read the .msg files of a generated package."""
    store = get_typestore(Stores.EMPTY)
    types: dict[str, Any] = {}
    for name in ("Time", "Duration"):
        types.update(get_types_from_msg("int32 sec\nuint32 nanosec\n", f"builtin_interfaces/msg/{name}"))
    for path in sorted((generated / "ros" / package / "msg").glob("*.msg")):
        types.update(get_types_from_msg(path.read_text(encoding="utf-8"), f"{package}/msg/{path.stem}"))
    store.register(types)
    return store


def plain(value: Any, store: Typestore) -> Any:
    """A value of rosbags as plain Python, a message as a mapping of its fields."""
    if hasattr(value, "__msgtype__"):
        _, fields = store.fielddefs[value.__msgtype__]
        return {name: plain(getattr(value, name), store) for name, _ in fields if name != _PLACEHOLDER}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(item, store) for item in value] if isinstance(value, list) else value


# --- the check --------------------------------------------------------------------------------------------------


def check(table: Path) -> None:
    """Raise `AssertionError` where a handler does something else than the IR and rosbags."""
    compiled = compile_table(table)
    write(table.parent, compare(table.parent, compiled.files, compiled.folders), overwrite=True)
    registry = load_registry(table.parent, compiled.bridge.python_package)
    store, walker = typestore(table.parent / compiled.bridge.folder, registry.package), Walker(compiled.bridge)
    native = NativeCheck(registry)
    in_any = sorted({member.proto for conversion in compiled.bridge.anys for member in conversion.members})
    assert len(registry.handlers) == len(compiled.bridge.routes) > 0
    for route in compiled.bridge.routes:
        handler = registry.by_number[route.number]
        if route.conversion:
            _check_handler(handler, route.conversion, walker, store, Payloads(in_any), native)
            _check_any_number(handler, native)
            _check_refusals(handler, route.conversion, native)
    check_standard_topics(
        registry, compiled.bridge, plain, native, "distro: jazzy" in table.read_text(encoding="utf-8")
    )
    native.finish()


def _check_handler(
    handler: Any, conversion: Conversion, walker: Walker, store: Typestore, random: Payloads, native: NativeCheck
) -> None:
    type_name = handler.message_type.__msgtype__

    @given(random.of(handler.payload_type.DESCRIPTOR))
    def both_ways(payload: Any) -> None:
        native.to_cdr(handler, payload)
        try:
            expected = walker.message(conversion, payload)
        except RefusedError:
            _must_refuse(handler, payload)
            return
        serialized = handler.to_cdr(payload)
        theirs = store.deserialize_cdr(serialized, type_name)
        _must_be(plain(theirs, store), expected)
        message = bytes(store.serialize_cdr(theirs, type_name))
        native.to_proto(handler, message)
        back = handler.from_cdr(message)
        assert back == walker.settle(conversion, payload)
        assert handler.to_cdr(back) == serialized

    both_ways()


def _must_refuse(handler: Any, payload: Payload) -> None:
    with pytest.raises(ConversionError, match=rf"^{handler.route.name}\."):
        handler.to_cdr(payload)


def _must_be(found: Any, expected: Any) -> None:
    """Compare what was read with what is expected; None stands for whatever a field holds that says nothing."""
    if isinstance(expected, dict):
        assert list(found) == list(expected)
        for name, value in expected.items():
            _must_be(found[name], value)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected):
            _must_be(one, other)
    else:
        assert expected is None or found == expected, (found, expected)


def _check_any_number(handler: Any, native: NativeCheck) -> None:
    """A number that its enum does not declare, as a newer board may send it, crosses or is a `ConversionError`.

    Of a closed enum, protobuf sets it aside; the field is absent then, and no other number takes its place.
    """

    @given(st.integers(-(2**31), 2**31 - 1))
    def any_number(number: int) -> None:
        fields = handler.payload_type.DESCRIPTOR.fields
        for field in fields:
            if field.enum_type is None or number in field.enum_type.values_by_number:
                continue
            if field.enum_type.is_closed:
                if not any(other.is_required for other in fields):
                    _must_not_be_taken(handler, field.name, number, native)
                    sent = _varint(field.number << 3) + _varint(number % 2**64)
                    _must_be_absent(handler, handler.payload_type.FromString(sent))
                continue
            payload = handler.payload_type(**{field.name: [number] if field.is_repeated else number})
            native.to_cdr(handler, payload)
            try:
                back = handler.from_cdr(handler.to_cdr(payload))
            except ConversionError:
                continue
            assert getattr(back, field.name) == getattr(payload, field.name)

    any_number()


def _varint(number: int) -> bytes:
    groups = [number >> shift & 0x7F for shift in range(0, max(1, number.bit_length()), 7)]
    return bytes([*(group | 0x80 for group in groups[:-1]), groups[-1]])


def _must_not_be_taken(handler: Any, name: str, number: int, native: NativeCheck) -> None:
    """A ROS message with the number, where its field can hold that, is no payload."""
    message = handler.message_type(**{f"has_{name}": True}) if hasattr(handler.message_type, f"has_{name}") else None
    if message is not None and 0 <= number < 2**8:
        setattr(message, name, number)
        native.to_proto(handler, cdr.encode(message))
        with pytest.raises(ConversionError):
            handler.from_cdr(cdr.encode(message))


def _must_be_absent(handler: Any, payload: Payload) -> None:
    assert handler.to_cdr(payload) == handler.to_cdr(handler.payload_type())


def _check_refusals(handler: Any, conversion: Conversion, native: NativeCheck) -> None:
    """What no payload says is a `ConversionError` that names route and field."""
    types = {field.name: field.type for field in fields_of(handler.message_type)}
    for field in conversion.fields:
        wrong: Any
        message, name = handler.message_type(), field.ros.name
        if field.kind is ConversionKind.WHICH:
            wrong = 13
        elif field.entry is not None:
            element: Any = types[name]
            wrong = [element.element(), element.element()]
        elif field.kind is ConversionKind.JSON and not (field.repeated or field.which):
            wrong = "{"
        elif field.kind is ConversionKind.WELL_KNOWN and not (field.repeated or field.which or field.presence):
            wrong = types[name](0, 1_000_000_000)
        else:
            continue
        setattr(message, name, wrong)
        native.to_proto(handler, cdr.encode(message))
        with pytest.raises(ConversionError, match=rf"^{handler.route.name}\.{name}: "):
            handler.from_cdr(cdr.encode(message))


def serve() -> None:
    """Check each project that is named, until there is no more."""
    suppressed = {"database": None, "deadline": None, "suppress_health_check": list(HealthCheck)}
    # The generator loads its templates, and Hypothesis the constants of all modules, once for all forks.
    settings(max_examples=9, **suppressed)(given(st.integers() | st.text() | st.floats())(lambda _: None))()
    for number, line in enumerate(sys.stdin):
        examples, _, project = line.rstrip("\n").partition(" ")
        if number == 0:
            compile_table(Path(project, "mapping.yaml"))
        child = os.fork()
        if not child:
            settings.register_profile("asked", max_examples=int(examples), **suppressed)
            settings.load_profile("asked")
            _check_and_exit(Path(project))
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


def _check_and_exit(project: Path) -> NoReturn:
    os.chdir(project)
    sys.path[0] = str(project)
    code = 1
    try:
        check(project / "mapping.yaml")
        code = 0
    except BaseException:  # noqa: BLE001  # pytest's Failed is none of the exceptions
        (project / "crosscheck.log").write_text(traceback.format_exc(), encoding="utf-8")
    finally:
        os._exit(code)  # what Python does at its end is the parent's to do


if __name__ == "__main__":
    serve()
