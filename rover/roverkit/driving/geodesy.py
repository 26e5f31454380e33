"""Positions near a datum, on a plane that touches the ellipsoid of WGS 84 there (x east, y north, as in REP 103)."""

from __future__ import annotations

import math
from dataclasses import dataclass

_SEMI_MAJOR_M = 6_378_137.0  # NIMA TR8350.2, table 3.1
_FLATTENING = 1 / 298.257223563
_ECCENTRICITY_SQUARED = _FLATTENING * (2 - _FLATTENING)


@dataclass(frozen=True, slots=True)
class Datum:
    """Origin of a plane: ``latitude`` and ``longitude`` in degrees, ``altitude`` in metres above the ellipsoid.

    On the plane, one degree of latitude or longitude has the length that it has at the datum. Within a kilometre of it,
    and up to 60 degrees of latitude, this is less than 0.2 m beside the true position. The antimeridian
    is no border: longitudes differ by at most half a turn.
    """

    latitude: float
    longitude: float
    altitude: float = 0.0

    def geodetic(self, x: float, y: float) -> tuple[float, float]:
        """Return the latitude and longitude, in degrees, of a point ``x`` metres east and ``y`` metres north of it."""
        east, north = self._metres_per_degree
        return self.latitude + y / north, math.remainder(self.longitude + x / east, 360)

    def planar(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return the metres to the east and to the north of a latitude and a longitude in degrees."""
        east, north = self._metres_per_degree
        return math.remainder(longitude - self.longitude, 360) * east, (latitude - self.latitude) * north

    @property
    def _metres_per_degree(self) -> tuple[float, float]:
        """Lengths of one degree of longitude and of latitude, from the radii of curvature of the ellipsoid."""
        latitude = math.radians(self.latitude)
        part = 1 - _ECCENTRICITY_SQUARED * math.sin(latitude) ** 2
        across = _SEMI_MAJOR_M / math.sqrt(part)
        along = across * (1 - _ECCENTRICITY_SQUARED) / part
        return math.radians(across + self.altitude) * math.cos(latitude), math.radians(along + self.altitude)
