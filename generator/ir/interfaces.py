"""IR of ROS 2's standard messages, such as sensor_msgs/msg/Imu: definitions, and expressions that fill their fields.

As in `roverlink.generator.ir.model`, nothing here depends on YAML, on protobuf, or on a programming language.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Path = tuple[str, ...]
"""Path of a nested field, from the outermost name to its own: ``("pose", "position", "x")``."""

Scalar = bool | int | float | str
Value = Scalar | tuple[Scalar, ...]
"""Constant value of a ROS field, as written in mapping.yaml."""


# --- definitions ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class InterfaceType:
    """Type of a standard message's field: primitive, ``string``, message, or an array or sequence of one of these."""

    name: str
    """Name of the type, or of the elements' type: ``float64`` for ``float64[9]``."""
    length: int | None = None
    """Length of an array; None if it is not an array."""
    is_sequence: bool = False
    bound: int | None = None
    """Largest length of a sequence; None if it is unlimited."""
    text_bound: int | None = None
    """Largest length of a string; None if it is unlimited."""

    @property
    def is_message(self) -> bool:
        """True for a message, and for an array or sequence of messages."""
        return "/" in self.name

    @property
    def is_many(self) -> bool:
        """True for an array or a sequence."""
        return self.is_sequence or self.length is not None

    def __str__(self) -> str:
        if self.is_sequence:
            return f"{self.name}[{'' if self.bound is None else f'<={self.bound}'}]"
        return self.name if self.length is None else f"{self.name}[{self.length}]"


@dataclass(frozen=True, slots=True)
class InterfaceField:
    """Field of a standard message."""

    name: str
    type: InterfaceType


@dataclass(frozen=True, slots=True)
class InterfaceConstant:
    """Constant of a standard message."""

    name: str
    type: str
    value: int | float | str | bool


@dataclass(frozen=True, slots=True)
class Interface:
    """Standard message: a message of a ROS 2 package such as sensor_msgs."""

    name: str
    """Full name, such as ``sensor_msgs/msg/Imu``."""
    fields: tuple[InterfaceField, ...]
    constants: tuple[InterfaceConstant, ...]

    @property
    def package(self) -> str:
        """Package of the message, such as ``sensor_msgs``."""
        return self.name.partition("/")[0]

    @property
    def local_name(self) -> str:
        """Name within the package, such as ``Imu``."""
        return self.name.rpartition("/")[2]


# --- expressions that fill fields -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SourceEnum:
    """Enum that is the type of a payload's field."""

    name: str
    """Full name with the proto package, such as ``rover.Arm.Mode``."""
    proto_package: str
    """Proto package, the start of the full name; empty if there is none."""
    file: str
    """.proto file that declares it, relative to the proto root."""

    @property
    def local_name(self) -> str:
        """Name without the proto package, such as ``Arm.Mode``."""
        return self.name.removeprefix(f"{self.proto_package}.")


@dataclass(frozen=True, slots=True)
class Source:
    """Field of the payload from which the value of a ROS field is taken."""

    path: Path
    type: str
    """ROS primitive type with the same values as the proto field, such as ``int32`` for ``sint32``.

    It is ``string`` or ``bytes`` for proto fields of these types.
    """
    repeated: bool = False
    optional: bool = False
    """True if the field distinguishes *absent* from *zero*."""
    enum: SourceEnum | None = None
    """Enum of the field; None if it has another type."""
    oneof: str = ""
    """Name of the oneof that contains the field, or that contains a message around the field; empty if there is none.
    """

    @property
    def dotted(self) -> str:
        """Path with dots, as mapping.yaml writes it: ``pose.position.x``."""
        return ".".join(self.path)

    @property
    def is_integer(self) -> bool:
        """True if the field holds integers."""
        return "int" in self.type

    @property
    def bits(self) -> int:
        """Number of bits of an integer."""
        return 64 if "64" in self.type else 32


@dataclass(frozen=True, slots=True)
class Scaling:
    """Linear conversion of a number: ``(number * factor + offset) * π ** pi``.

    `pi` is -1, 0 or 1, so that a factor such as 180/π is stored without rounding. If `pi` is not 0, the offset is 0.
    """

    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    pi: int = 0
    unit: str = ""
    """Unit of the number before the conversion, as mapping.yaml writes it: ``deg``; empty if there is none."""
    to: str = ""
    """Unit of the number after the conversion; empty if there is none."""

    @property
    def is_identity(self) -> bool:
        """True if the conversion changes nothing."""
        return self.factor == 1 and not self.offset and not self.pi

    @property
    def is_whole(self) -> bool:
        """True if the conversion of an integer always gives an integer."""
        return self.factor.denominator == self.offset.denominator == 1 and not self.pi


@dataclass(frozen=True, slots=True)
class Constant:
    """Expression: a constant value, the same in every message."""

    value: Value
    name: str = ""
    """Name of a ROS message's constant, if mapping.yaml gives the value by this name (``STATUS_FIX``); else empty."""
    holder: str = ""
    """Full name of the ROS message that declares the constant; empty without a name."""

    @property
    def shown(self) -> Value:
        """Name of the constant if it has one, otherwise its value, as mapping.yaml writes it."""
        return self.name or self.value


@dataclass(frozen=True, slots=True)
class Taken:
    """Expression: the value of a payload field, after the conversion of its unit."""

    source: Source
    scaling: Scaling = Scaling()
    rounded: bool = False
    """True if the result is rounded to the nearest integer."""
    default: Constant | None = None
    """Value that is used if the payload does not contain the field; None if there is none."""


@dataclass(frozen=True, slots=True)
class Case:
    """One value of a proto enum, with the constant that the ROS field gets for it."""

    number: int
    name: str
    counterpart: Constant
    """Value of the ROS field."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """Expression: a constant that depends on an enum field of the payload.

    mapping.yaml lists the constant for each enum value.
    """

    source: Source
    cases: tuple[Case, ...]
    default: Constant | None = None
    """Constant for every enum value that is not in `cases`; None if such a value is an error."""


@dataclass(frozen=True, slots=True)
class Rotation:
    """Expression: a quaternion, computed from roll, pitch and yaw in radians.

    These are rotations about the fixed axes x, y and z, applied in this order (REP 103).
    """

    roll: Taken | Constant
    pitch: Taken | Constant
    yaw: Taken | Constant


@dataclass(frozen=True, slots=True)
class Moment:
    """Expression: a time or duration from a field of the payload, or the time of the datagram's reception."""

    source: Source | None
    """Field of the payload; None for a time that the caller of the conversion tells."""
    nanoseconds: Fraction = Fraction(1)
    """Number of nanoseconds in one unit of the payload's field."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardTime(Moment):
    """Expression: the time of measuring by the clock of the board, at which the caller stamps the message."""

    counter: Source
    """Field of the payload that counts since the start of the board, in units of `nanoseconds`."""


@dataclass(frozen=True, slots=True)
class Unset:
    """Expression for a ROS field that the conversion does not fill. The field keeps its default value."""


@dataclass(frozen=True, slots=True)
class Parts:
    """Expression: a nested ROS message, with one expression for each of its fields."""

    fields: tuple[TargetField, ...]


Expression = Taken | Chosen | Constant | Rotation | Moment | Unset | Parts


@dataclass(frozen=True, slots=True)
class TargetField:
    """Field of a standard message, and the expression that fills it."""

    name: str
    type: InterfaceType
    value: Expression


@dataclass(frozen=True, slots=True)
class Recovered:
    """Field of a standard message that is converted in both directions, and the expression for its value.

    If the expression is ``speed * 2``, the payload's field ``speed`` is computed back as half of the message's field.
    """

    path: Path
    """Path of the field in the standard message."""
    type: InterfaceType
    """Type of the field in the standard message."""
    value: Taken | Chosen | Rotation | Moment
