"""ROS 2 messages as dataclasses whose annotations are ROS types.

A message class is a dataclass that derives from `Message` and names its type in ``__msgtype__``::

    @dataclass(slots=True)
    class BoundingBox(Message):
        __msgtype__ = "comms/msg/BoundingBox"

        x: UInt32 = 0
        corners: list[Float32] = dataclasses.field(default_factory=list)

A type checker sees ``x`` as an ``int``; `fields_of`, and through it the CDR codec and the middlewares, see a
``uint32``. ``uint8[]`` is ``bytes``, a nested message is its class, and a bound or a length is an annotation
(``Annotated[list[Float32], Bound(8)]``, ``Annotated[bytes, Length(4)]``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from inspect import get_annotations
from typing import Annotated, Any, ClassVar, ParamSpec, TypeVar, Union, get_args, get_origin

P = ParamSpec("P")
R = TypeVar("R")


class Message:
    """Base class of every ROS 2 message class."""

    __slots__ = ()
    __msgtype__: ClassVar[str]
    __typehash__: ClassVar[str] = ""
    """Type hash (REP 2016, ``RIHS01_...``), which ROS 2 compares from Iron on; empty if unknown."""


def how_to_install(message_type: type[Message]) -> str:
    """Return a help text that tells the user how to install or update the ROS 2 package of a message.

    If the package is generated from the table, the text names a ``colcon build`` command. Otherwise the package belongs
    to ROS 2, and the text names an ``apt install`` command.
    """
    # Classes of services are beside those of messages.
    generated, ours, _ = message_type.__module__.replace(".services.", ".messages.").partition(".messages.")
    if ours:
        return f"run `colcon build --base-paths {generated.replace('.', '/')}/ros` and source its setup.bash"
    package = message_type.__msgtype__.partition("/")[0]
    return f"run `apt install ros-$ROS_DISTRO-{package.replace('_', '-')}`"


@dataclass(frozen=True, slots=True)
class Primitive:
    """ROS primitive type: its ROS name, its `struct` format character, and its size in bytes."""

    name: str
    format: str
    size: int


@dataclass(frozen=True, slots=True)
class Bound:
    """Annotation of a field of limited size: the largest number of elements of a sequence, or of bytes of a string."""

    count: int


@dataclass(frozen=True, slots=True)
class Length:
    """Annotation of a field that is a fixed-size array: its number of elements."""

    count: int


Bool = Annotated[bool, Primitive("bool", "?", 1)]
Byte = Annotated[int, Primitive("byte", "B", 1)]
Char = Annotated[int, Primitive("char", "B", 1)]
Int8 = Annotated[int, Primitive("int8", "b", 1)]
UInt8 = Annotated[int, Primitive("uint8", "B", 1)]
Int16 = Annotated[int, Primitive("int16", "h", 2)]
UInt16 = Annotated[int, Primitive("uint16", "H", 2)]
Int32 = Annotated[int, Primitive("int32", "i", 4)]
UInt32 = Annotated[int, Primitive("uint32", "I", 4)]
Int64 = Annotated[int, Primitive("int64", "q", 8)]
UInt64 = Annotated[int, Primitive("uint64", "Q", 8)]
Float32 = Annotated[float, Primitive("float32", "f", 4)]
Float64 = Annotated[float, Primitive("float64", "d", 8)]

PRIMITIVES: dict[str, Any] = {
    get_args(annotation)[1].name: annotation
    for annotation in (
        *(Bool, Byte, Char, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64),
        *(Float32, Float64),
    )
}
"""Annotation of each primitive type, by its ROS name: ``uint32`` -> `UInt32`."""

UINT8 = Primitive("uint8", "B", 1)


@dataclass(frozen=True, slots=True)
class Text:
    """ROS type ``string``; ``bound`` is the largest number of bytes, or None if there is no limit."""

    bound: int | None = None


@dataclass(frozen=True, slots=True)
class Sequence:
    """ROS sequence type, such as ``float32[]``; ``bound`` is the largest number of elements, or None for no limit.

    The value of ``uint8[]`` is a ``bytes`` object.
    """

    element: FieldType
    bound: int | None = None


@dataclass(frozen=True, slots=True)
class Array:
    """ROS array type with exactly ``length`` elements, such as ``float64[9]``.

    The value of a ``uint8`` array is a ``bytes`` object.
    """

    element: FieldType
    length: int


FieldType = Union[Primitive, Text, Sequence, Array, "type[Message]"]


@dataclass(frozen=True, slots=True)
class Field:
    """Field of a message: its name and its ROS type."""

    name: str
    type: FieldType


def cached_by_type(function: Callable[P, R]) -> Callable[P, R]:
    """Cache a function like `functools.cache`, but keep the signature that a type checker sees.

    mypy does not regard a message class as hashable. So with `functools.cache` it would report every call that passes a
    message class.
    """
    # Message classes are few and live as long as the process, so an unbounded cache is safe.
    remembered: Callable[..., R] = cache(function)
    return remembered


@cached_by_type
def fields_of(message_type: type[Message]) -> tuple[Field, ...]:
    """Return the fields of a message class in wire order.

    Raises `TypeError` if an annotation is not a ROS type.
    """
    hints: dict[str, Any] = {}
    for kind in reversed(message_type.__mro__):
        # `from __future__ import annotations` makes them strings. typing.get_type_hints takes three times as long.
        hints |= get_annotations(kind, eval_str=True)
    return tuple(
        Field(name, type_of(hint))
        for name, hint in hints.items()
        if get_origin(hint) is not ClassVar and not name.startswith("__")
    )


def messages_in(message_type: type[Message]) -> list[type[Message]]:
    """Return the message classes inside a message at any depth. Each occurs once, in the order of first use."""
    found: dict[type[Message], None] = {}
    for field in fields_of(message_type):
        inner: FieldType = field.type
        while isinstance(inner, (Sequence, Array)):
            inner = inner.element
        if isinstance(inner, type):
            found |= dict.fromkeys((inner, *messages_in(inner)))
    return list(found)


def type_of(hint: Any) -> FieldType:
    """Return the ROS type for a field's annotation: ``str`` -> ``Text()``.

    Raises `TypeError` if the annotation stands for no ROS type.
    """
    marks: tuple[Any, ...] = ()
    if get_origin(hint) is Annotated:
        hint, *rest = get_args(hint)
        marks = tuple(rest)
    for mark in marks:
        if isinstance(mark, Primitive):
            return mark
    bound = next((mark.count for mark in marks if isinstance(mark, Bound)), None)
    if hint is str:
        return Text(bound)
    if isinstance(hint, type) and issubclass(hint, Message):
        return hint
    element = _element_type(hint)
    length = next((mark.count for mark in marks if isinstance(mark, Length)), None)
    return Sequence(element, bound) if length is None else Array(element, length)


def _element_type(hint: Any) -> FieldType:
    if hint is bytes:
        return UINT8
    if get_origin(hint) is list:
        return type_of(get_args(hint)[0])
    raise TypeError(f"{hint!r} is not the annotation of a ROS 2 type")


def default_of(field_type: FieldType) -> Callable[[], Any]:
    """Return a function that makes the default value of a field type, such as 0, False or an empty string."""
    if isinstance(field_type, Primitive):
        return {"?": bool, "f": float, "d": float}.get(field_type.format, int)
    if isinstance(field_type, Text):
        return str
    if isinstance(field_type, Sequence):
        return bytes if field_type.element == UINT8 else list
    if isinstance(field_type, Array):
        return _array_default(field_type)
    return field_type


def _array_default(array: Array) -> Callable[[], Any]:
    if array.element == UINT8:
        return lambda: bytes(array.length)
    element = default_of(array.element)
    return lambda: [element() for _ in range(array.length)]
