"""Last values of the rows of a bridge, and their history over the last minutes, for plots."""

from __future__ import annotations

import math
import time
from array import array
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

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
_TURN_S = 0.001
_EXACT = 2**53  # JavaScript's numbers are exact up to here

Values = dict[str, Any]
"""Values of a message by the path of the field, such as ``pose.position.x`` or ``joints[2]``."""


class _Point(NamedTuple):
    time: float
    names: tuple[str, ...]
    numbers: array[float]


class History:
    """Numbers of the last minutes by row and field; memory is bounded. Safe to read from other threads."""

    def __init__(self) -> None:
        self._points: dict[str, deque[_Point]] = {}

    def add(self, row: str, now: float, values: Mapping[str, Any]) -> None:
        """Keep the numbers among the values of a row at the time ``now``; texts are left out."""
        numbers = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
        points = self._points.setdefault(row, deque(maxlen=_POINTS))
        names = tuple(numbers)
        if points and points[-1].names == names:
            names = points[-1].names  # one tuple for all points, to save memory
        points.append(_Point(now, names, array("d", numbers.values())))

    def keep(self, rows: Collection[str]) -> None:
        """Forget all rows but these."""
        self._points = {row: points for row, points in self._points.items() if row in rows}

    def series(self, row: str, field: str) -> list[tuple[float, float]]:
        """Return times and numbers of a field, oldest first; an empty list if there are none."""
        # A copy: the thread that adds points must not change the list that is read. `list` of a deque is one step.
        points = list(self._points.get(row, ()))
        return [(point.time, point.numbers[point.names.index(field)]) for point in points if field in point.names]


class _NewestMessage:
    """Function that keeps the newest message of a row (see `NewestTap`)."""

    def __init__(self, newest: dict[str, bytes], row: str, sources: Sources) -> None:
        self._newest, self._row, self.sources = newest, row, sources

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:  # noqa: ARG002  # of each tap
        if messages:
            self._newest[self._row] = messages[-1]


class LastValues:
    """Listener that keeps the last message of each row, and converts it later on the thread of the page.

    So the bridge's threads only store a reference for each batch.
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

    def changes(self) -> Iterator[tuple[str, Values]]:
        """Yield name and values of each row that has had a message since the last call."""
        self._sources()
        turn = time.monotonic()
        for row, data in list(self._newest.items()):
            if data is self._shown.get(row):
                continue
            self._shown[row] = data
            try:
                yield row, flat(message_to_values(cdr.decode(self._types[row], data)))
            except MISFITS:  # another node sent bytes that are not of this type; the bridge counts that
                continue
            # Python changes threads only every 5 ms unless one waits; so the bridge gets its turn every millisecond.
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
