"""Source code that converts a number to another unit, ``payload.pressure_kpa * 1000.0``, and the inverse conversion.

A `Scaling` of the IR describes the conversion of the number. The arithmetic operators are the same in C++ and Python,
so both targets use this module. A `Dialect` describes how one of the languages writes numbers and constants.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from roverlink.generator.ir.interfaces import Scaling

_EXACT = 2**53
"""Limit up to which a double represents every integer exactly."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """Spelling of numbers, powers and constants in a programming language."""

    separator: str
    """Character between groups of three digits in a number: ``_`` in Python's ``1_000``."""
    pi: str
    """Expression for π: ``math.pi`` in Python."""
    power: str
    """Format string of a power, with the placeholders ``base`` and ``exponent``: ``{base}**{exponent}`` in Python."""
    constant: str
    """Format string for the name of a constant such as ``DEG_TO_RAD``, with the placeholder ``name``."""

    def number(self, value: Fraction, *, whole: bool) -> str:
        """Return the literal of a number: an integer if ``whole`` is true, else the nearest float.

        >>> Dialect("_", "math.pi", "{base}**{exponent}", "_{name}").number(Fraction(1_000_000), whole=False)
        '1_000_000.0'
        """
        if value.denominator == 1 and abs(value) < _EXACT:
            return f"{int(value):_}".replace("_", self.separator) + ("" if whole else ".0")
        return repr(float(value))


class Arithmetic:
    """Writer of expressions that convert numbers. It collects the constants that the expressions use."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self.constants: dict[str, str] = {}
        """Expression of each constant, by the constant's name: ``{"DEG_TO_RAD": "math.pi / 180"}``."""

    def scaled(self, text: str, scaling: Scaling, *, whole: bool) -> str:
        """Return the expression that converts a number by a scaling: ``payload.kpa * 1000.0``.

        ``text`` is the expression of the number, here ``payload.kpa``. ``whole`` is true if the result must be an
        integer.
        """
        if scaling.pi:
            return f"{self._pi_operand(text, scaling)} * {self._constant(scaling)}"
        if _shifted_first(scaling):
            shifted = self._plus(text, scaling.offset / scaling.factor, whole=whole)
            return self._times(f"({shifted})", scaling.factor, whole=whole)
        return self._plus(self._times(text, scaling.factor, whole=whole), scaling.offset, whole=whole)

    def back(self, text: str, scaling: Scaling, *, whole: bool) -> str:
        """Return the expression that inverts a scaling: it computes the original number from the scaled number.

        ``text`` is the expression of the scaled number. ``whole`` is true if the result must be an integer.
        """
        if scaling.pi:
            size = abs(scaling.factor)
            shifted = self._plus(f"{text} / {self._constant(scaling)}", -scaling.offset / size, whole=False)
            return _negated(shifted) if scaling.factor < 0 else shifted
        if _shifted_first(scaling):
            return self._plus(
                self._by(text, scaling.factor, whole=whole), -scaling.offset / scaling.factor, whole=whole
            )
        shifted = self._plus(text, -scaling.offset, whole=whole)
        inner = f"({shifted})" if scaling.offset and scaling.factor != 1 else shifted
        return self._by(inner, scaling.factor, whole=whole)

    def _times(self, text: str, factor: Fraction, *, whole: bool) -> str:
        """Return the expression ``text`` multiplied by a factor, with the operator whose result has the least rounding.

        The result is ``x / 1.8`` for the factor 5/9, and ``-x / 1000.0`` for -1/1000. The number 1.8 has few digits,
        whereas 0.5555... would be rounded.
        """
        number = self._dialect.number
        size = abs(factor)
        text = f"-{text}" if factor < 0 else text
        if size == 1:
            return text
        if size.denominator == 1:
            return f"{text} * {number(size, whole=whole)}"
        if size.numerator == 1 or (_is_decimal(1 / size) and not _is_decimal(size)):
            return f"{text} / {number(1 / size, whole=False)}"
        if _is_decimal(size):
            return f"{text} * {number(size, whole=False)}"
        above, below = Fraction(size.numerator), Fraction(size.denominator)
        return f"{text} * {number(above, whole=False)} / {number(below, whole=False)}"

    def _by(self, text: str, factor: Fraction, *, whole: bool) -> str:
        """Return the expression ``text`` divided by a factor. This is the inverse of `_times`."""
        if _is_decimal(factor) and abs(factor).numerator != 1:
            text = f"-{text}" if factor < 0 else text
            return text if abs(factor) == 1 else f"{text} / {self._dialect.number(abs(factor), whole=False)}"
        return self._times(text, 1 / factor, whole=whole)

    def _plus(self, text: str, offset: Fraction, *, whole: bool) -> str:
        if not offset:
            return text
        return f"{text} {'-' if offset < 0 else '+'} {self._dialect.number(abs(offset), whole=whole)}"

    def _pi_operand(self, text: str, scaling: Scaling) -> str:
        """Return the left operand of ``x * DEG_TO_RAD``: the expression ``text`` with the scaling's sign and offset."""
        size = abs(scaling.factor)
        signed = f"-{text}" if scaling.factor < 0 else text
        return f"({self._plus(signed, scaling.offset / size, whole=False)})" if scaling.offset else signed

    def _constant(self, scaling: Scaling) -> str:
        """Return the name of the constant for a scaling that contains π. Add the constant to `constants`."""
        size, pi = abs(scaling.factor), self._dialect.pi
        power = pi if abs(scaling.pi) == 1 else self._dialect.power.format(base=pi, exponent=abs(scaling.pi))
        if scaling.pi > 0:
            value = self._times(power, size, whole=True)
        else:
            value = f"{self._dialect.number(size, whole=True)} / {power}"
        known = {f"{pi} / 180.0": ("DEG_TO_RAD", f"{pi} / 180"), f"180 / {pi}": ("RAD_TO_DEG", f"180 / {pi}")}
        word, value = known.get(value, (f"{_word(scaling.unit)}_TO_{_word(scaling.to)}", value))
        name = self._dialect.constant.format(name=word)
        while self.constants.setdefault(name, value) != value:
            name += "_"
        return name


def _is_decimal(value: Fraction) -> bool:
    """Return True if the decimal notation of a number is finite, as for 1/8 but not for 1/3."""
    bottom = value.denominator
    for prime in (2, 5):
        while bottom % prime == 0:
            bottom //= prime
    return bottom == 1


def _shifted_first(scaling: Scaling) -> bool:
    """Return True if the offset has to be added before the multiplication, as in ``(fahrenheit - 32.0) / 1.8``.

    If it were added after the multiplication, the offset would be a number with infinitely many digits, -160/9.
    """
    return not _is_decimal(scaling.offset) and _is_decimal(scaling.offset / scaling.factor)


def _negated(text: str) -> str:
    return f"-({text})" if " + " in text or " - " in text else f"-{text}"


def _word(unit: str) -> str:
    """Return a unit as a part of a constant's name: ``M_PER_S`` for ``m/s``."""
    return re.sub(r"\W+", "_", unit.replace("/", "_PER_").replace("%", "PERCENT")).strip("_").upper() or "1"
