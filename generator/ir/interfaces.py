"""IR of ROS 2's standard messages: their definitions, and the expressions that fill their fields.

As in `roverlink.generator.ir.model`, nothing here knows YAML, protobuf, or how a language spells an expression.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Path = tuple[str, ...]
"""Names of the enclosing messages' fields, then the field's own name."""

Scalar = bool | int | float | str
Value = Scalar | tuple[Scalar, ...]
"""Value of a field, as written in the table."""


# --- definitions ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class InterfaceType:
    """Type of a field: a primitive, ``string`` or a message by its full name; or an array or sequence of it."""

    name: str
    length: int | None = None
    """Length of an array; None if it is not an array."""
    is_sequence: bool = False
    bound: int | None = None
    """Largest length of a sequence; None if unbounded."""
    text_bound: int | None = None
    """Largest length of a string; None if unbounded."""

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
    """Standard message: a message of another package."""

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
    """Enum of a payload's field."""

    name: str
    """Full name."""
    proto_package: str
    """Proto package, the start of the full name; empty if there is none."""
    file: str
    """.proto file that declares it, relative to the proto root."""

    @property
    def local_name(self) -> str:
        """Name without the package."""
        return self.name.removeprefix(f"{self.proto_package}.")


@dataclass(frozen=True, slots=True)
class Source:
    """Field of the payload, as the source of a value."""

    path: Path
    type: str
    """ROS primitive type with the same values; ``string`` or ``bytes``."""
    repeated: bool = False
    optional: bool = False
    """True if the field distinguishes *absent* from *zero*."""
    enum: SourceEnum | None = None
    """Enum of the field; None if it has another type."""
    oneof: str = ""
    """Oneof that contains the field, or a message that holds it; empty if there is none."""

    @property
    def dotted(self) -> str:
        """Path with dots, as the table writes it."""
        return ".".join(self.path)

    @property
    def is_integer(self) -> bool:
        """True if the field holds integers."""
        return "int" in self.type


@dataclass(frozen=True, slots=True)
class Scaling:
    """Conversion of a number: ``(number * factor + offset) * π ** pi``.

    `pi` is -1, 0 or 1, so that factors such as 180/π stay exact fractions. If it is not 0, the offset is 0.
    """

    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    pi: int = 0
    unit: str = ""
    """Unit of the number, as the table writes it; empty if there is none."""
    to: str = ""
    """Unit of the result."""

    @property
    def is_identity(self) -> bool:
        """True if the conversion changes nothing."""
        return self.factor == 1 and not self.offset and not self.pi

    @property
    def is_whole(self) -> bool:
        """True if integers are converted to integers."""
        return self.factor.denominator == self.offset.denominator == 1 and not self.pi


@dataclass(frozen=True, slots=True)
class Constant:
    """Constant value, the same in every message."""

    value: Value
    name: str = ""
    """Constant of a ROS message, if the table gives the value by this name; else empty."""
    holder: str = ""
    """Full name of that ROS message."""

    @property
    def shown(self) -> Value:
        """Name, or else the value, as the table writes it."""
        return self.name or self.value


@dataclass(frozen=True, slots=True)
class Taken:
    """Field of the payload after scaling."""

    source: Source
    scaling: Scaling = Scaling()
    rounded: bool = False
    """True if a fraction is rounded to the nearest integer."""
    default: Constant | None = None
    """Value for an absent field."""


@dataclass(frozen=True, slots=True)
class Case:
    """Value of an enum, and the value that replaces it."""

    number: int
    name: str
    counterpart: Constant


@dataclass(frozen=True, slots=True)
class Chosen:
    """Value that the table chooses by the value of an enum."""

    source: Source
    cases: tuple[Case, ...]
    default: Constant | None = None
    """Value for every other enum value."""


@dataclass(frozen=True, slots=True)
class Rotation:
    """Quaternion from angles in radians about the fixed axes x, y and z, in this order (REP 103)."""

    roll: Taken | Constant
    pitch: Taken | Constant
    yaw: Taken | Constant


@dataclass(frozen=True, slots=True)
class Moment:
    """Time or duration: a field of the payload, or, without a source, the time at which the datagram was received."""

    source: Source | None
    nanoseconds: Fraction = Fraction(1)
    """Nanoseconds in one unit of the field."""


@dataclass(frozen=True, slots=True)
class Unset:
    """Default value that the field has in a new message."""


@dataclass(frozen=True, slots=True)
class Parts:
    """Nested message, field by field."""

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
    """Expression that can be inverted: the payload's fields are computed from its value in a message."""

    path: Path
    """Path of the field in the standard message."""
    type: InterfaceType
    """Type of that field."""
    value: Taken | Chosen | Rotation | Moment
