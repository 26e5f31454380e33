"""Last values of the rows of a bridge, and their history over the last minutes, for plots.

Mostly nobody looks. So messages are kept as they came, and read when a browser asks for their values.
"""

from __future__ import annotations

import math
import time
from array import array
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import MISFITS, Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.tap import Sources, Tap
from roverlink.runtime.text.values import message_to_values

HISTORY_S = 300.0
"""Time in seconds over which values are kept."""
_POINTS = 600  # of a row; the page looks at the values twice a second
_FIELDS = 100  # of a row
_ELEMENTS = 16  # of an array
_LONGEST = 200  # characters of a text
_SHORT = 1024  # bytes; the numbers of a message have a few bytes more than the message
_TURN_S = 0.001
_EXACT = 2**53  # JavaScript's numbers are exact up to here

T = TypeVar("T")
Values = dict[str, Any]
"""Values of a message by the path of the field, such as ``pose.position.x`` or ``joints[2]``."""


class SeenMessage:
    """Newest message of a row at a moment at which the page looked. It is decoded only if somebody asks for it."""

    __slots__ = ("_data", "_type")

    def __init__(self, message_type: type[Message], data: bytes) -> None:
        self._type, self._data = message_type, data

    @property
    def is_short(self) -> bool:
        """True if it needs no more memory than its numbers."""
        return len(self._data) <= _SHORT

    def values(self) -> Values | None:
        """Return the values; None if another node has sent bytes that are not of this type (the bridge counts that)."""
        try:
            return flat(message_to_values(cdr.decode(self._type, self._data)))
        except MISFITS:
            return None


class _Numbers(NamedTuple):
    names: tuple[str, ...]
    numbers: array[float]


class _Point:
    """Numbers of a row at one moment. Those of a message are read when somebody first asks for them."""

    __slots__ = ("_content", "time")

    def __init__(self, time: float, content: Values | SeenMessage) -> None:
        self.time = time
        self._content: Values | SeenMessage | _Numbers = content

    def numbers(self, like: tuple[str, ...] = ()) -> _Numbers:
        """Return the numbers; ``like`` are the names of another point, which are one tuple for both if they are equal.

        Texts are left out.
        """
        content = self._content
        if not isinstance(content, _Numbers):
            values = (content.values() or {}) if isinstance(content, SeenMessage) else content
            numbers = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
            names = tuple(numbers)
            self._content = content = _Numbers(like if names == like else names, array("d", numbers.values()))
        return content


class History:
    """Numbers of the last minutes by row and field; memory is bounded. Safe to read from other threads."""

    def __init__(self) -> None:
        self._points: dict[str, deque[_Point]] = {}

    def add(self, row: str, now: float, content: Values | SeenMessage) -> None:
        """Keep the numbers of a row at the time ``now``."""
        points = self._points.setdefault(row, deque(maxlen=_POINTS))
        point = _Point(now, content)
        if not (isinstance(content, SeenMessage) and content.is_short):
            point.numbers(points[-1].numbers().names if points else ())
        points.append(point)

    def keep(self, rows: Collection[str]) -> None:
        """Forget all rows but these."""
        self._points = {row: points for row, points in self._points.items() if row in rows}

    def series(self, row: str, field: str) -> list[tuple[float, float]]:
        """Return times and numbers of a field, oldest first; an empty list if there are none."""
        found, names = list[tuple[float, float]](), tuple[str, ...]()
        # A copy: the thread that adds points must not change the list that is read. `list` of a deque is one step.
        for point in in_turns(list(self._points.get(row, ()))):
            names, numbers = point.numbers(names)
            if field in names:
                found.append((point.time, numbers[names.index(field)]))
        return found


class _NewestMessage:
    """Function that keeps the newest message of a row (see `NewestTap`)."""

    def __init__(self, newest: dict[str, bytes], row: str, sources: Sources) -> None:
        self._newest, self._row, self.sources = newest, row, sources

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:  # noqa: ARG002  # of each tap
        if messages:
            self._newest[self._row] = messages[-1]


class LastValues:
    """Listener that keeps the last message of each row.

    So the bridge's threads only store a reference for each batch, and the thread of the page the newest of them.
    """

    def __init__(self, rows: Mapping[str, str]) -> None:
        """Listen to the topics that are keys of ``rows``; its values are the names of their rows."""
        self._rows = rows
        self._newest: dict[str, bytes] = {}
        self._types: dict[str, type[Message]] = {}
        self._shown: dict[str, bytes] = {}
        self._sources = Sources()

    def topic(self, topic: str, message_type: type[Message], qos: Qos) -> Tap | None:  # noqa: ARG002  # not needed
        """Return a function that keeps the newest message of a row's topic; None for other topics."""
        row = self._rows.get(topic)
        if row is None:
            return None
        self._types[row] = message_type
        return _NewestMessage(self._newest, row, self._sources)

    def changes(self) -> dict[str, SeenMessage]:
        """Return the newest message of each row that has had one since the last call, by the name of the row."""
        self._sources()
        fresh = {row: data for row, data in list(self._newest.items()) if data is not self._shown.get(row)}
        self._shown.update(fresh)
        return {row: SeenMessage(self._types[row], data) for row, data in fresh.items()}


def values_of(messages: Mapping[str, SeenMessage]) -> dict[str, Values]:
    """Return the values of the messages that can be decoded."""
    read = ((row, messages[row].values()) for row in in_turns(list(messages)))
    return {row: values for row, values in read if values is not None}


def in_turns(items: Iterable[T]) -> Iterator[T]:
    """Yield items whose work takes long, and let other threads work meanwhile.

    Python changes threads only every 5 ms unless one waits; so the bridge gets its turn every millisecond.
    """
    turn = time.monotonic()
    for item in items:
        yield item
        if time.monotonic() - turn > _TURN_S:
            time.sleep(_TURN_S / 2)
            turn = time.monotonic()


def flat(values: Mapping[str, Any]) -> Values:
    """Return the values of a message by the paths of the fields; long arrays and texts are cut.

    NaN, infinity and integers that JavaScript cannot hold become texts.
    """
    found: Values = {}
    _collect(values, "", found)
    return found


def _collect(value: Any, path: str, found: Values) -> None:
    if len(found) >= _FIELDS:
        return
    if isinstance(value, Mapping):
        for name, part in value.items():
            _collect(part, f"{path}.{name}" if path else str(name), found)
    elif isinstance(value, list):
        for index, element in enumerate(value[:_ELEMENTS]):
            _collect(element, f"{path}[{index}]", found)
        if len(value) > _ELEMENTS:
            found[f"{path}[]"] = f"{len(value)} elements"
    elif isinstance(value, str):
        found[path] = value[:_LONGEST]
    elif (isinstance(value, float) and not math.isfinite(value)) or (isinstance(value, int) and abs(value) > _EXACT):
        found[path] = str(value)
    else:
        found[path] = value
