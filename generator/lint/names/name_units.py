"""Units, scales and references (relative or absolute) in names of fields.

Examples are `speed_mm_per_s`, `angle_deg_x100` and `delta_position_mm`. A change of the unit shows in the name only.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

_DEGREE = math.pi / 180
# The size of a unit in SI units. All definitions are exact: 1 inch = 0.0254 m, 1 mph = 0.44704 m/s, and the standard
# gravity 9.80665 m/s^2. The spellings are the ones that people use in fields' names, where `°` and `/` cannot stand.
_OF_DIMENSION: dict[str, dict[str, float]] = {
    "length": {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1, "km": 1e3, "inch": 0.0254, "ft": 0.3048}
    | {"millimeters": 1e-3, "centimeters": 1e-2, "meters": 1, "metres": 1, "kilometers": 1e3},
    "angle": {"rad": 1, "mrad": 1e-3, "radians": 1, "rev": 2 * math.pi, "turns": 2 * math.pi}
    | {"deg": _DEGREE, "degrees": _DEGREE, "cdeg": _DEGREE / 100, "mdeg": _DEGREE / 1000}
    | {"centidegrees": _DEGREE / 100, "decidegrees": _DEGREE / 10, "millidegrees": _DEGREE / 1000},
    "time": {"s": 1, "sec": 1, "secs": 1, "seconds": 1, "ms": 1e-3, "msec": 1e-3, "millis": 1e-3}
    | {"us": 1e-6, "usec": 1e-6, "micros": 1e-6, "ns": 1e-9, "min": 60, "minutes": 60, "h": 3600, "hours": 3600},
    "speed": {"mps": 1, "kmh": 1 / 3.6, "kph": 1 / 3.6, "mph": 0.44704},
    "acceleration": {"mps2": 1, "ms2": 1, "gs": 9.80665},
    "turning": {"rpm": 2 * math.pi / 60, "rps": 2 * math.pi, "dps": _DEGREE},
    "voltage": {"v": 1, "mv": 1e-3, "uv": 1e-6, "kv": 1e3, "volts": 1, "millivolts": 1e-3},
    "current": {"a": 1, "ma": 1e-3, "ua": 1e-6, "amps": 1, "amperes": 1, "milliamps": 1e-3},
    "power": {"w": 1, "mw": 1e-3, "kw": 1e3, "watts": 1},
    "energy": {"j": 1, "kj": 1e3, "wh": 3600, "kwh": 3.6e6},
    "charge": {"ah": 1, "mah": 1e-3},
    "frequency": {"hz": 1, "khz": 1e3, "mhz": 1e6, "ghz": 1e9},
    "mass": {"g": 1e-3, "kg": 1, "mg": 1e-6},
    "pressure": {"pa": 1, "hpa": 100, "kpa": 1e3, "bar": 1e5, "mbar": 100},
    "part": {"percent": 1e-2, "pct": 1e-2, "permille": 1e-3, "ppm": 1e-6, "ratio": 1, "fraction": 1},
}
_WITHOUT_SIZE = {
    "temperature": (
        "celsius",
        "degc",
        "kelvin",
        "fahrenheit",
        "degf",
    ),  # their zeros differ, so that a factor cannot convert them
    "count": ("raw", "ticks", "counts", "steps", "lsb"),  # their size depends on the device
}
_UNITS: dict[str, tuple[str, float | None]] = {
    **{unit: (dimension, size) for dimension, units in _OF_DIMENSION.items() for unit, size in units.items()},
    **{unit: (dimension, None) for dimension, names in _WITHOUT_SIZE.items() for unit in names},
}
# `uptime_min` is a time in minutes, but `speed_min` is the smallest speed.
_TIMES = frozenset({"time", "uptime", "runtime", "timeout", "duration", "period", "interval", "delay", "age"})
_RELATIVE = frozenset({"delta", "relative", "rel", "diff", "increment"})
_ABSOLUTE = frozenset({"absolute", "abs"})
_SCALE = re.compile(r"x(?P<factor>[1-9]\d*)")


@dataclass(frozen=True, slots=True)
class Measure:
    """The quantity that a name describes, with unit, scale and reference (relative or absolute)."""

    words: tuple[str, ...]
    """The words that say what is measured, without unit, scale and reference: ``("speed",)`` for ``speed_mm_per_s``."""
    units: tuple[str, ...]
    """The unit, followed by the units that divide it: ``("mm", "s")`` for ``speed_mm_per_s``. Empty without a unit."""
    scale: int
    """The factor by which the sender multiplies the value: 100 for ``angle_deg_x100``."""
    relative: bool
    """True if the value is a difference, as in `delta_position`."""
    rate: bool
    """True if the unit in the name contains the word `per`, as in ``mm_per_s``."""

    @property
    def shown(self) -> str:
        """The unit, scale and reference as text for diagnostics: ``relative mm per s times 100``."""
        parts = ["relative"] * self.relative + [" per ".join(self.units)] * bool(self.units)
        return " ".join(parts + [f"times {self.scale}"] * (self.scale != 1)) or "the plain value"


def measure(words: Sequence[str]) -> Measure:
    """Find the unit, scale and reference in the words of a name, as `words` in the module ``name_words`` returns them.

    A unit or scale counts only at the end of the name, after at least one other word.
    """
    # At least one word has to remain as the measured quantity: a field may be called `delta` or `rpm`.
    subject = [word for word in words if word not in _RELATIVE | _ABSOLUTE] or list(words)
    relative = len(subject) < len(words) and not _RELATIVE.isdisjoint(words)
    end = len(subject)
    while end > 1 and _belongs_to_unit(subject[end - 1], subject[: end - 1]):
        end -= 1
    tail = subject[end:]
    scales = [int(match["factor"]) for match in map(_SCALE.fullmatch, tail) if match]
    units = tuple(word for word in tail if word in _UNITS)
    return Measure(tuple(subject[:end]), units, math.prod(scales), relative, "per" in tail)


def _belongs_to_unit(word: str, before: Sequence[str]) -> bool:
    if word == "min" and {*_TIMES, "per"}.isdisjoint(before):
        return False
    return word in _UNITS or word == "per" or _SCALE.fullmatch(word) is not None


def is_unit(word: str) -> bool:
    """Return True if a word is a unit, such as ``mm``. Some units are letters with other meanings, too."""
    return word in _UNITS


def disagree(old: Measure, new: Measure) -> bool:
    """Return True if two names have different units, scales or references.

    If only one of the names has a unit, the units do not count as different, unless this unit contains `per`.
    """
    # A unit that was added to a name documents the meaning that the number already had. With `per`, the value is
    # another quantity (a rate) in any case.
    units = old.units != new.units and bool((old.units and new.units) or old.rate != new.rate)
    return units or old.scale != new.scale or old.relative != new.relative


def factor(old: Measure, new: Measure) -> float | None:
    """Return how many times too large a new receiver reads the value of an old sender.

    This is 1000 if the unit was mm and is now m. Returns None if the factor is unknown, or if no factor can convert the
    values.
    """
    sizes = [_size(unit) for unit in (old, new)]
    if old.relative != new.relative or sizes[0] is None or sizes[1] is None or sizes[0][0] != sizes[1][0]:
        return None
    return (sizes[1][1] / new.scale) / (sizes[0][1] / old.scale)


def _size(of: Measure) -> tuple[tuple[str, ...], float] | None:
    """Return the dimensions of a unit and its size in SI units, such as ``("length", "time"), 0.001`` for mm per s.

    Returns None if a part of the unit has no known size.
    """
    size, dimensions = 1.0, []
    for position, unit in enumerate(of.units):
        dimension, factor = _UNITS[unit]
        if factor is None:
            return None
        dimensions.append(dimension)
        size = size / factor if position else factor
    return tuple(dimensions), size
