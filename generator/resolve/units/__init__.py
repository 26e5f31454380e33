"""Units of measurement: expressions such as ``m/s^2``, with their dimension and their exact conversion to SI.

A library would know more units, but its import takes longer than a whole run of `generate`. The tests compare this
package with such a library.
"""

from roverlink.generator.resolve.units.expression import UnitError, parse
from roverlink.generator.resolve.units.unit import Unit, conversion

__all__ = ["Unit", "UnitError", "conversion", "parse"]
