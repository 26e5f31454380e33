"""Rows of the table whose messages ask for the size of a rock, and answer."""

from __future__ import annotations

import math
from collections.abc import Sequence

from roverkit.rocks.measurement import Line
from roverkit.rocks.rocks_declaration import REQUEST, RESULT
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr


class RockRows:
    """Rows `REQUEST` and `RESULT` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, or lacks a field."""
        self.request, self.result = REQUEST.of(registry), RESULT.of(registry)
        self._asked, self._told = registry.by_name[REQUEST.row], registry.by_name[RESULT.row]

    def line(self, data: bytes) -> Line:
        """Return the line of a serialized request. Raises `ConversionError` if it is damaged."""
        message = cdr.decode(self.request.message_type, data)
        x1, y1, x2, y2 = (float(getattr(message, name)) for name in REQUEST.fields)
        return x1, y1, x2, y2

    def answer(self, size: Sequence[float] | None, request: bytes) -> bytes:
        """Return the serialized result with a length and a width in metres; without a size, both fields are NaN.

        If the table says by which field a result belongs to its request, it gets the value of the serialized
        ``request``.
        """
        # The message has no field for a failure. 0 is a number, which a page shows as a size and a mean contains. And
        # without an answer, the operator takes the last one for it.
        values = (math.nan, math.nan) if size is None else [100 * metres for metres in size]
        result = self.result.message_type(**dict(zip(RESULT.fields, values)))
        settings = self._asked.route.request
        if settings is None or not settings.field:
            return cdr.encode(result)
        payload = self._told.from_ros(result)
        setattr(payload, settings.field, getattr(self._asked.from_cdr(request), settings.field))
        return self._told.to_cdr(payload)
