"""Units of measurement: expressions such as ``m/s^2`` as a dimension and an exact way to the SI unit.

A library would know more units, but takes longer to start than everything that `generate` does; the tests hold this
one against such a library.
"""

from roverlink.generator.resolve.units.expression import UnitError, parse
from roverlink.generator.resolve.units.unit import Unit, conversion

__all__ = ["Unit", "UnitError", "conversion", "parse"]
