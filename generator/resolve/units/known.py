"""Units that the table may use, by their symbols.

They are exact by definition: the units of the SI (BIPM, The International System of Units, 9th edition), and the inch,
foot, mile, pound and knot by the agreements of 1929 and 1959. ``g`` is the gram, as in the SI; the standard
acceleration of free fall is ``g0``.
"""

from __future__ import annotations

from fractions import Fraction

from roverlink.generator.resolve.units.unit import BASES, DIMENSIONLESS, Unit

PREFIXES = {
    "Y": 24,
    "Z": 21,
    "E": 18,
    "P": 15,
    "T": 12,
    "G": 9,
    "M": 6,
    "k": 3,
    "h": 2,
    "da": 1,
    "d": -1,
    "c": -2,
    "m": -3,
    "u": -6,
    "µ": -6,
    "μ": -6,
    "n": -9,
    "p": -12,
    "f": -15,
    "a": -18,
}
"""Exponent of ten that each prefix stands for. Micro is written with one of two Unicode characters, or with u."""


def _base(name: str) -> Unit:
    return Unit(tuple(int(base == name) for base in BASES))


def _number(text: str) -> Fraction:
    return Fraction(text)


_ONE = Unit(DIMENSIONLESS)
_METRE, _KILOGRAM, _SECOND, _AMPERE, _KELVIN, _MOLE, _CANDELA, _RADIAN = map(_base, BASES)
_GRAM = _KILOGRAM.scaled(_number("1/1000"))
_MINUTE = _SECOND.scaled(_number("60"))
_HOUR = _MINUTE.scaled(_number("60"))
# pi/180 is no fraction, so the power of pi is counted by itself. deg to rev stays exact: pi cancels out.
_DEGREE = Unit(_RADIAN.dimension, _number("1/180"), 1)
_TURN = Unit(_RADIAN.dimension, _number("2"), 1)
_NEWTON = _KILOGRAM * _METRE * _SECOND**-2
_PASCAL = _NEWTON * _METRE**-2
_JOULE = _NEWTON * _METRE
_WATT = _JOULE * _SECOND**-1
_COULOMB = _AMPERE * _SECOND
_VOLT = _WATT * _AMPERE**-1
_OHM = _VOLT * _AMPERE**-1
_TESLA = _VOLT * _SECOND * _METRE**-2
_LITRE = (_METRE**3).scaled(_number("1/1000"))
_FREE_FALL = (_METRE * _SECOND**-2).scaled(_number("9.80665"))
_INCH = _METRE.scaled(_number("0.0254"))
_POUND_FORCE = (_KILOGRAM * _FREE_FALL).scaled(_number("0.45359237"))
_LUMEN = _CANDELA * _RADIAN**2  # a steradian is a squared radian

PREFIXED = {
    "m": _METRE,
    "g": _GRAM,
    "s": _SECOND,
    "A": _AMPERE,
    "K": _KELVIN,
    "mol": _MOLE,
    "cd": _CANDELA,
    "rad": _RADIAN,
    "N": _NEWTON,
    "Pa": _PASCAL,
    "J": _JOULE,
    "W": _WATT,
    "C": _COULOMB,
    "V": _VOLT,
    "ohm": _OHM,
    "Ω": _OHM,
    "T": _TESLA,
    "F": _COULOMB * _VOLT**-1,
    "H": _OHM * _SECOND,
    "Hz": _SECOND**-1,
    "L": _LITRE,
    "lm": _LUMEN,
    "lx": _LUMEN * _METRE**-2,
    "Wh": _WATT * _HOUR,
    "Ah": _AMPERE * _HOUR,
    "g0": _FREE_FALL,
    "G": _TESLA.scaled(_number("1/10000")),
    "bar": _PASCAL.scaled(_number("100000")),
}
"""Units that may have a prefix such as k, by symbol: ``Pa``, which also allows ``kPa``."""

PLAIN = {
    "1": _ONE,
    "%": _ONE.scaled(_number("1/100")),
    "ppm": _ONE.scaled(_number("1/1000000")),
    "min": _MINUTE,
    "h": _HOUR,
    "d": _HOUR.scaled(_number("24")),
    "deg": _DEGREE,
    "°": _DEGREE,
    "arcmin": _DEGREE.scaled(_number("1/60")),
    "arcsec": _DEGREE.scaled(_number("1/3600")),
    "rev": _TURN,
    "rpm": _TURN * _MINUTE**-1,
    "t": _KILOGRAM.scaled(_number("1000")),
    "atm": _PASCAL.scaled(_number("101325")),
    "psi": _POUND_FORCE * _INCH**-2,
    "lbf": _POUND_FORCE,
    "lb": _KILOGRAM.scaled(_number("0.45359237")),
    "in": _INCH,
    "ft": _METRE.scaled(_number("0.3048")),
    "mi": _METRE.scaled(_number("1609.344")),
    "nmi": _METRE.scaled(_number("1852")),
    "kn": (_METRE * _HOUR**-1).scaled(_number("1852")),
    "degC": Unit(_KELVIN.dimension, offset=_number("273.15")),
    "°C": Unit(_KELVIN.dimension, offset=_number("273.15")),
    # 0 degF is 459.67 * 5/9 K = 45967/180 K.
    "degF": Unit(_KELVIN.dimension, _number("5/9"), offset=_number("45967/180")),
    "°F": Unit(_KELVIN.dimension, _number("5/9"), offset=_number("45967/180")),
}
"""Units that may not have a prefix, by symbol."""


def symbols() -> list[str]:
    """Return the symbols of all units, without prefixes."""
    return [*PREFIXED, *PLAIN]


def unit(symbol: str) -> Unit | None:
    """Return the unit of a symbol, which may begin with a prefix; None if the symbol is unknown."""
    if symbol in PLAIN:
        return PLAIN[symbol]
    if symbol in PREFIXED:
        return PREFIXED[symbol]
    for prefix, power in PREFIXES.items():
        rest = symbol.removeprefix(prefix)
        if rest != symbol and rest in PREFIXED:
            return PREFIXED[rest].scaled(Fraction(10) ** power)
    return None
