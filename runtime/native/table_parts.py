"""Parts of the native core's table that programs refer to: expressions, constants, and the payloads' layouts."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from collections.abc import Sequence as Items
from dataclasses import dataclass, field
from typing import Any

from google.protobuf.descriptor import Descriptor

from roverlink.runtime.core.messages import FieldType, Message
from roverlink.runtime.native.layout import NONE, Code, Expression, ExpressionFlag, Number, Op, Step
from roverlink.runtime.native.operations import (
    PRIMITIVES,
    ROS_TYPE,
    Json,
    field_at,
    op,
    primitive_of,
    source_of,
    type_code,
)
from roverlink.runtime.native.payload_layouts import PayloadLayouts, Place, UnsupportedError, message_in

_STEPS = {"negate": 0, "*": 1, "/": 2, "+": 3, "-": 4, "//": 5}


@dataclass
class TableParts:
    """Collector of the expressions and the constants of all programs."""

    messages: Mapping[str, Items[Json]]
    """Conversions of the package's messages, by the local name of the ROS message."""
    payloads: PayloadLayouts
    expressions: list[Expression] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)

    def conversions(self, message: type[Message]) -> Mapping[str, Json]:
        """Return the conversions of a package's message by ROS field. Raises `UnsupportedError`."""
        name = message.__msgtype__.rpartition("/")[2]
        if name not in self.messages:
            raise UnsupportedError(f"{message.__msgtype__} is for a google.protobuf.Any")
        return {one["ros"]: one for one in self.messages[name]}

    def which(self, one: Json, type: FieldType, message: type[Message], descriptor: Descriptor, slot: int) -> Op:
        """Return the operation for the member of a oneof, with the ROS constant of each member."""
        cases = self._member_cases(one, message, descriptor)
        return op(Code.WHICH, slot=slot, type=type_code(primitive_of(type)), a=self.words([len(cases) // 2, *cases]))

    def _member_cases(self, one: Json, message: type[Message], descriptor: Descriptor) -> list[int]:
        *holders, _ = one["proto"].split(".")
        holder = message_in(field_at(descriptor, ".".join(holders))) if holders else descriptor
        cases: list[int] = []
        for member, constant in one["choices"].items():
            cases += [holder.fields_by_name[member].number, getattr(message, constant)]
        return cases

    def words(self, words: list[int]) -> int:
        """Keep words, and return their index."""
        self.payloads.words += [word % 2**64 for word in words]
        return len(self.payloads.words) - len(words)

    def constant(self, data: bytes, aligned_to: str) -> Op:
        """Return the operation that writes constant bytes."""
        start, size = self.payloads.text(data)
        return op(Code.BYTES, a=start, b=size, type=PRIMITIVES.index(aligned_to))

    def cases(self, cases: Items[tuple[int, str]]) -> int:
        """Keep cases of numbers and texts, and return their index."""
        return self.words(
            [len(cases), *(word for number, text in cases for word in (number, *self.payloads.text(text)))]
        )

    def expression(self, expression: Expression) -> int:
        """Keep an expression, and return its index."""
        self.expressions.append(expression)
        return len(self.expressions) - 1

    def number(self, one: Json, descriptor: Descriptor, place: Place | None = None) -> Expression:
        """Return the expression for a number of the payload, or for a constant."""
        if "constant" in one:
            return self.made({"otherwise": one["constant"]}, NONE, Number.DOUBLE)
        place = place or self.payloads.place(descriptor, one["from"])
        ros = ROS_TYPE.get(place.field.type)
        if ros is None:
            raise UnsupportedError(f"{place.field.full_name} is no number")
        source = source_of(ros)
        return self.made(
            one, place.slot, source, presence=place.slot if "otherwise" in one and "cases" not in one else NONE
        )

    def made(self, one: Json, slot: int, source: Number, presence: int = NONE) -> Expression:
        """Return the expression for the number in a slot; ``one`` says what is done with it."""
        first = len(self.steps)
        for operator, value in one.get("steps", ()):
            whole = isinstance(value, int)
            self.steps.append(Step(_STEPS[operator], whole, 0.0 if whole else value, value if whole else 0))
        flags = ExpressionFlag.ROUND * one.get("round", False) | ExpressionFlag.CHECK_SINGLE * one.get("single", False)
        cases = NONE
        if "cases" in one:
            listed = [word for key, value in one["cases"] for word in (key, *_value(value))]
            cases = self.words([len(one["cases"]), *listed])
        otherwise = self.words(list(_value(one["otherwise"]))) if "otherwise" in one else NONE
        return Expression(source, flags, len(self.steps) - first, slot, presence, first, cases, otherwise)


def _value(value: Any) -> tuple[int, int]:
    """Return a constant as two words: 1 and an integer, or 0 and the bits of a double."""
    if isinstance(value, (bool, int)):
        return 1, int(value)
    if isinstance(value, float):
        return 0, int(struct.unpack("<Q", struct.pack("<d", value))[0])
    raise UnsupportedError(f"{value!r} is no number")
