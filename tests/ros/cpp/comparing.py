"""Whether the C++ handlers of a table do what its Python handlers do, on the same bytes, both ways."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping, Set
from pathlib import Path
from typing import Any

from google.protobuf.message import Message as Payload
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from roverlink.runtime import ConversionError, Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Sequence, Text, fields_of
from roverlink.runtime.interfaces import Time

sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parents[2] / "generator"))
from polling import PATIENCE_S
from random_payloads import Payloads

_TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=4)
_JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | _TEXTS,
    lambda values: st.lists(values, max_size=3) | st.dictionaries(_TEXTS, values, max_size=3),
    max_leaves=5,
)
_JSON_TEXTS = st.one_of(
    st.builds(json.dumps, _JSON, ensure_ascii=st.booleans()),
    st.sampled_from(
        ["", '{"a": 1}', '{"a": 1, "a": 2}', "[1.5e3, null]", '"\\ud83d\\ude00"', '"\\ud800"', '{"b": {"c": [false]}}']
    ),
    st.sampled_from(["1e400", "1e-400", "-0", " true ", "[1,,2]", "NaN", "{", "01", "0.1"]),
)
"""Texts that protobuf's JSON parser and Python's both read or both refuse; cpp/tests/json_texts.tsv has others."""
_SAID = settings(database=None, deadline=None, suppress_health_check=list(HealthCheck))


class Speaker:
    """The program of `speaker.cpp`."""

    def __init__(self, program: Path, environment: Mapping[str, str] | None = None) -> None:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self._process = subprocess.Popen([program], env=environment, **pipes)  # type: ignore[call-overload]

    def ask(self, *question: object) -> bytes | str:
        """The bytes that it answers, or why it refuses."""
        words = [word.hex() or "-" if isinstance(word, bytes) else str(word) for word in question]
        self._process.stdin.write(" ".join(words) + "\n")
        self._process.stdin.flush()
        kind, _, said = self._process.stdout.readline().strip().partition(" ")
        assert kind in ("is", "refused"), f"the program ended at {' '.join(words)}"
        data = bytes.fromhex("" if said == "-" else said)
        return data if kind == "is" else data.decode(errors="replace")

    def close(self) -> None:
        """End it."""
        self._process.stdin.close()
        assert self._process.wait(PATIENCE_S) == 0


def compare(
    speaker: Speaker,
    registry: Registry,
    in_any: list[str],
    examples: int,
    json_fields: Set[tuple[str, str]] = frozenset(),
) -> int:
    """How many answers were the same; `AssertionError` at the first that is not.

    ``json_fields`` are the fields that hold JSON: the name of a ROS message, and that of its field.
    """
    comparison = _Comparison(speaker, registry)
    for handler in (*registry.handlers, *registry.extra_topics):
        payloads = Payloads(in_any).of(handler.payload_type.DESCRIPTOR)
        stamps = st.builds(Time, st.integers(0, 2**31 - 1), st.integers(0, 10**9 - 1))
        numbers = st.integers(-(2**31), 2**31 - 1)
        said = settings(_SAID, max_examples=examples)
        messages = _messages(handler.message_type, json_fields).map(cdr.encode)
        said(given(st.just(handler), payloads, stamps)(comparison.there))()
        said(given(st.just(handler), numbers)(comparison.undeclared))()
        said(given(st.just(handler), messages)(comparison.back))()
    return comparison.answers


class _Comparison:
    def __init__(self, speaker: Speaker, registry: Registry) -> None:
        self._speaker, self._registry = speaker, registry
        self.answers = 0

    def there(self, handler: Any, payload: Payload, stamp: Time) -> None:
        """A payload, as it is on the wire, becomes the same message; and that becomes the same payload."""
        wire = payload.SerializePartialToString()
        payload = handler.payload_type.FromString(wire)
        if handler.route.inbound:
            wire = self._registry.envelope(**{handler.route.name: payload}).SerializePartialToString()
        try:
            expected: bytes | None = handler.to_cdr(payload, stamp)
        except ConversionError:
            expected = None
        self._must_be(expected, "to", handler.route.topic, stamp.sec, stamp.nanosec, wire)
        if expected is not None:
            self.back(handler, expected)

    def undeclared(self, handler: Any, number: int) -> None:
        """A number that an open enum does not declare."""
        for field in handler.payload_type.DESCRIPTOR.fields:
            if field.enum_type is not None and not field.enum_type.is_closed and not field.is_repeated:
                self.there(handler, handler.payload_type(**{field.name: number}), Time())

    def back(self, handler: Any, message: bytes) -> None:
        """A message becomes the same payload, and of an outbound row the same envelope."""
        topic = handler.route.topic
        try:
            payload: Payload | None = handler.from_cdr(message)
        except ConversionError:
            payload = None
        self._must_be(payload, "from", topic, message)
        if not handler.route.inbound and payload is not None and payload.IsInitialized():
            envelope = self._registry.envelope(**{handler.route.name: payload})
            self._must_be(envelope, "envelope", topic, message)

    def _must_be(self, expected: bytes | Payload | None, *question: object) -> None:
        found = self._speaker.ask(*question)
        if expected is None:
            assert isinstance(found, str), (question, found)
        else:  # the order of a map's entries on the wire is each library's own
            assert not isinstance(found, str), (question, found, expected)
            same = type(expected).FromString(found) if isinstance(expected, Payload) else found
            # Their texts are looked at where there is a NaN, which equals nothing.
            assert same == expected or str(same) == str(expected), (question, same, expected)
        self.answers += 1


# --- random messages of ROS 2, which say what no payload would, too ---------------------------------------------------


def _messages(message_type: type[Message], json_fields: Set[tuple[str, str]]) -> st.SearchStrategy[Message]:
    name = message_type.__msgtype__.rpartition("/")[2]
    values = {
        field.name: _values(field.type, json_fields, _JSON_TEXTS if (name, field.name) in json_fields else _TEXTS)
        for field in fields_of(message_type)
    }
    return st.builds(message_type, **values)


def _values(
    type: FieldType, json_fields: Set[tuple[str, str]], texts: st.SearchStrategy[str]
) -> st.SearchStrategy[Any]:
    if isinstance(type, Primitive):
        return _numbers(type)
    if isinstance(type, Text):
        return texts
    if isinstance(type, (Sequence, Array)):
        length = {"max_size": min(3, type.bound or 3)} if isinstance(type, Sequence) else _exactly(type.length)
        if type.element == Primitive("uint8", "B", 1):
            return st.binary(**length)
        return st.lists(_values(type.element, json_fields, texts), **length)
    return _messages(type, json_fields)


def _exactly(length: int) -> dict[str, int]:
    return {"min_size": length, "max_size": length}


def _numbers(type: Primitive) -> st.SearchStrategy[Any]:
    if type.format == "?":
        return st.booleans()
    if type.format in "fd":
        return st.floats(allow_nan=False, width=8 * type.size)
    low = -(2 ** (8 * type.size - 1)) if type.format.islower() else 0
    return st.one_of(st.integers(0, 4), st.integers(low, low + 2 ** (8 * type.size) - 1))
