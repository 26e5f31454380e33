"""Spelling of scalings in code, in both directions: ``payload.pressure_kpa * 1000.0``, ``message.x / DEG_TO_RAD``.

Operators are the same in most languages; a `Dialect` has a language's numbers and constants.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from roverlink.generator.ir.interfaces import Scaling

_EXACT = 2**53
"""Largest power of two up to which a double represents every integer."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """Spelling of numbers and constants in a language."""

    separator: str
    """Separator between groups of three digits."""
    pi: str
    power: str
    """Format of a power, with the places ``base`` and ``exponent``."""
    constant: str
    """Format of a constant's name, with the place ``name``."""

    def number(self, value: Fraction, *, whole: bool) -> str:
        """Return a literal: of an integer if `whole`, else of the nearest float.

        >>> Dialect("_", "math.pi", "{base}**{exponent}", "_{name}").number(Fraction(1_000_000), whole=False)
        '1_000_000.0'
        """
        if value.denominator == 1 and abs(value) < _EXACT:
            return f"{int(value):_}".replace("_", self.separator) + ("" if whole else ".0")
        return repr(float(value))


class Arithmetic:
    """Speller of scalings. It collects the constants that they need."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self.constants: dict[str, str] = {}
        """Names and values of the constants."""

    def scaled(self, text: str, scaling: Scaling, *, whole: bool) -> str:
        """Return the expression of the scaled number; `whole` if all numbers are integers."""
        if scaling.pi:
            return f"{self._pi_operand(text, scaling)} * {self._constant(scaling)}"
        if _shifted_first(scaling):
            shifted = self._plus(text, scaling.offset / scaling.factor, whole=whole)
            return self._times(f"({shifted})", scaling.factor, whole=whole)
        return self._plus(self._times(text, scaling.factor, whole=whole), scaling.offset, whole=whole)

    def back(self, text: str, scaling: Scaling, *, whole: bool) -> str:
        """Return the expression that recovers the number from the scaled one."""
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
        """Return a product with the operation that rounds least: ``x / 1.8`` for 5/9, ``-x / 1000.0`` for -1/1000.

        1.8 has few digits, whereas 0.5555... would be rounded.
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
        """Return a quotient, the inverse of `_times`."""
        if _is_decimal(factor) and abs(factor).numerator != 1:
            text = f"-{text}" if factor < 0 else text
            return text if abs(factor) == 1 else f"{text} / {self._dialect.number(abs(factor), whole=False)}"
        return self._times(text, 1 / factor, whole=whole)

    def _plus(self, text: str, offset: Fraction, *, whole: bool) -> str:
        if not offset:
            return text
        return f"{text} {'-' if offset < 0 else '+'} {self._dialect.number(abs(offset), whole=whole)}"

    def _pi_operand(self, text: str, scaling: Scaling) -> str:
        """Return the operand of the constant: the number with its sign and offset."""
        size = abs(scaling.factor)
        signed = f"-{text}" if scaling.factor < 0 else text
        return f"({self._plus(signed, scaling.offset / size, whole=False)})" if scaling.offset else signed

    def _constant(self, scaling: Scaling) -> str:
        """Return the name of the constant for a factor with pi."""
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
    """Return True if a number has finitely many decimal digits."""
    bottom = value.denominator
    for prime in (2, 5):
        while bottom % prime == 0:
            bottom //= prime
    return bottom == 1


def _shifted_first(scaling: Scaling) -> bool:
    """Return True if the offset is shorter before the scaling than after it, as in (F - 32) / 1.8."""
    return not _is_decimal(scaling.offset) and _is_decimal(scaling.offset / scaling.factor)


def _negated(text: str) -> str:
    return f"-({text})" if " + " in text or " - " in text else f"-{text}"


def _word(unit: str) -> str:
    """Return a unit as a part of a constant's name."""
    return re.sub(r"\W+", "_", unit.replace("/", "_PER_").replace("%", "PERCENT")).strip("_").upper() or "1"
