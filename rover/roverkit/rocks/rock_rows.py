"""Rows of the table whose messages ask for the size of a rock, and answer."""

from __future__ import annotations

import math

from roverkit.rocks.measurement import Line, RockSize
from roverkit.rocks.rocks_declaration import FAILURE, REQUEST, RESULT, SIGMAS
from roverkit.rocks.unmeasurable import Unmeasurable
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import fields_of

_FAILURE_PREFIX = "ROCK_MEASURE_FAILURE_"


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

    def answer(self, found: RockSize | Unmeasurable, request: bytes) -> bytes:
        """Return the serialized result with a size, or with the reason why there is none.

        A message without fields for sigmas and reasons gets the sizes alone. If the table says by which field a result
        belongs to its request, it gets the value of the serialized ``request``.
        """
        # Without a size, all are NaN, for who does not know the reasons. 0 is a number, which a page shows as a size
        # and a mean contains. And without an answer, the operator takes the last one for it.
        size = None if isinstance(found, Unmeasurable) else found
        metres = (size.length, size.width, size.length_sigma, size.width_sigma) if size else (math.nan,) * 4
        values: dict[str, float] = {name: 100 * value for name, value in zip((*RESULT.fields, *SIGMAS), metres)}
        kind = self.result.message_type
        if isinstance(found, Unmeasurable):
            values[FAILURE] = getattr(kind, f"{_FAILURE_PREFIX}{found.name}", 0)
        known = {field.name for field in fields_of(kind)}
        result = kind(**{name: value for name, value in values.items() if name in known})
        settings = self._asked.route.request
        if settings is None or not settings.field:
            return cdr.encode(result)
        payload = self._told.from_ros(result)
        setattr(payload, settings.field, getattr(self._asked.from_cdr(request), settings.field))
        return self._told.to_cdr(payload)
