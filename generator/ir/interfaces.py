"""The part of the IR that is about messages of ROS 2's common interfaces: their definitions, and what fills them.

As in `roverlink.generator.ir.model`, nothing here knows YAML, protobuf, or how any language spells an expression.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Path = tuple[str, ...]
"""The name of a field, after those of the messages that hold it."""

Scalar = bool | int | float | str
Value = Scalar | tuple[Scalar, ...]
"""What a field can hold that stands in the table."""


# --- the definitions --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class InterfaceType:
    """A field's type: a primitive, ``string``, or a message by its full name; or many of it."""

    name: str
    length: int | None = None
    """Of an array."""
    is_sequence: bool = False
    bound: int | None = None
    """The largest length of a sequence."""
    text_bound: int | None = None
    """The largest length of a string."""

    @property
    def is_message(self) -> bool:
        """Whether it is a message, or many."""
        return "/" in self.name

    @property
    def is_many(self) -> bool:
        """Whether it is an array or a sequence."""
        return self.is_sequence or self.length is not None

    def __str__(self) -> str:
        if self.is_sequence:
            return f"{self.name}[{'' if self.bound is None else f'<={self.bound}'}]"
        return self.name if self.length is None else f"{self.name}[{self.length}]"


@dataclass(frozen=True, slots=True)
class InterfaceField:
    """A field of a message."""

    name: str
    type: InterfaceType


@dataclass(frozen=True, slots=True)
class InterfaceConstant:
    """A constant of a message."""

    name: str
    type: str
    value: int | float | str | bool


@dataclass(frozen=True, slots=True)
class Interface:
    """A message of a package that is not ours."""

    name: str
    """``sensor_msgs/msg/Imu``."""
    fields: tuple[InterfaceField, ...]
    constants: tuple[InterfaceConstant, ...]

    @property
    def package(self) -> str:
        """The package that it is of."""
        return self.name.partition("/")[0]

    @property
    def local_name(self) -> str:
        """Its name within the package."""
        return self.name.rpartition("/")[2]


# --- what fills a field -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Source:
    """A field of the payload."""

    path: Path
    type: str
    """The ROS primitive with the same values; ``string``, or ``bytes``."""
    repeated: bool = False
    optional: bool = False
    """Whether it tells *absent* from *zero*."""
    enum: str = ""
    """Full name of its enum; empty for none."""
    oneof: str = ""
    """The oneof that it, or a message that holds it, stands in; empty for none."""

    @property
    def dotted(self) -> str:
        """Its path as the table writes it."""
        return ".".join(self.path)

    @property
    def is_integer(self) -> bool:
        """Whether it holds whole numbers."""
        return "int" in self.type


@dataclass(frozen=True, slots=True)
class Scaling:
    """``(number * factor + offset) * pi ** pi``; the offset is zero where pi takes part."""

    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    pi: int = 0
    unit: str = ""
    """The unit of the number, as the table writes it; empty for none."""
    to: str = ""
    """The unit of the result."""

    @property
    def is_identity(self) -> bool:
        """Whether it changes nothing."""
        return self.factor == 1 and not self.offset and not self.pi

    @property
    def is_whole(self) -> bool:
        """Whether it makes whole numbers of whole numbers."""
        return self.factor.denominator == self.offset.denominator == 1 and not self.pi


@dataclass(frozen=True, slots=True)
class Taken:
    """A field of the payload, scaled."""

    source: Source
    scaling: Scaling = Scaling()
    rounded: bool = False
    """Whether a number with a fraction becomes the nearest whole one."""
    default: bool | int | float | str | None = None
    """What stands for an absent field."""


@dataclass(frozen=True, slots=True)
class Case:
    """A value of an enum and what it becomes."""

    number: int
    name: str
    value: int | float | str | bool
    constant: str
    """The constant of the target's message that has the value; empty for none."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """What a table says of an enum's value."""

    source: Source
    cases: tuple[Case, ...]
    holder: str
    """Full name of the message whose constants they are."""
    default: Case | None = None
    """For every other value."""


@dataclass(frozen=True, slots=True)
class Constant:
    """The same in every message."""

    value: Value


@dataclass(frozen=True, slots=True)
class Rotation:
    """A quaternion, from angles about the fixed axes x, y and z in this order (REP-103), in radians."""

    roll: Taken | Constant
    pitch: Taken | Constant
    yaw: Taken | Constant


@dataclass(frozen=True, slots=True)
class Moment:
    """A time, or a duration: of a field of the payload, or, of none, when the datagram was received."""

    source: Source | None
    nanoseconds: Fraction = Fraction(1)
    """In one of what the field counts."""


@dataclass(frozen=True, slots=True)
class Unset:
    """What the field has in a new message."""


@dataclass(frozen=True, slots=True)
class Parts:
    """A message, field by field."""

    fields: tuple[TargetField, ...]


Expression = Taken | Chosen | Constant | Rotation | Moment | Unset | Parts


@dataclass(frozen=True, slots=True)
class TargetField:
    """A field of a message, and what fills it."""

    name: str
    type: InterfaceType
    value: Expression


@dataclass(frozen=True, slots=True)
class Recovered:
    """An expression from whose value in a message the payload's fields can be told."""

    path: Path
    """Of the target's field."""
    type: InterfaceType
    """That field's type."""
    value: Taken | Chosen | Rotation | Moment
