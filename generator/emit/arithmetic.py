"""Source code that converts a number to another unit, ``payload.pressure_kpa * 1000.0``, and the inverse conversion.

A `Scaling` of the IR describes the conversion of the number. The arithmetic operators are the same in C++ and Python,
so both targets use this module. A `Dialect` describes how one of the languages writes numbers and constants.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

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
    constant: str
    """Format string for the name of a constant such as ``DEG_TO_RAD``, with the placeholder ``name``."""

    def number(self, value: Fraction, *, whole: bool) -> str:
        """Return the literal of a number: an integer if ``whole`` is true, else the nearest float.

        >>> Dialect("_", "math.pi", "_{name}").number(Fraction(1_000_000), whole=False)
        '1_000_000.0'
        """
        if value.denominator == 1 and abs(value) < _EXACT:
            return f"{int(value):_}".replace("_", self.separator) + ("" if whole else ".0")
        return repr(float(value))


@dataclass(frozen=True, slots=True)
class Factor:
    """Factor that contains π: ``size * π ** pi``."""

    size: Fraction
    pi: int
    """Exponent of π: 1 or -1."""

    @property
    def value(self) -> float:
        """Value of the factor, rounded as the generated constant is: ``math.pi / 180``."""
        if self.pi < 0:
            return int(self.size) / math.pi if self.size.denominator == 1 else float(self.size) / math.pi
        return _applied(math.pi, _times(self.size, whole=True))


@dataclass(frozen=True, slots=True)
class Step:
    """Operation on a number, such as ``* 1000.0``."""

    operator: Literal["negate", "*", "/", "//", "+", "-"]
    operand: Fraction | Factor = Fraction(0)
    """Right operand; without meaning for ``negate``."""
    whole: bool = False
    """True if the operand is an integer, so that an integer stays one."""

    @property
    def value(self) -> int | float:
        """Value of the operand in generated code."""
        if isinstance(self.operand, Factor):
            return self.operand.value
        return int(self.operand) if self.whole else float(self.operand)


def steps(scaling: Scaling, *, whole: bool) -> tuple[Step, ...]:
    """Return the operations that convert a number by a scaling. ``whole`` is true if an integer must stay one."""
    if scaling.pi:
        size = abs(scaling.factor)
        negated = [Step("negate")] if scaling.factor < 0 else []
        return (*negated, *_plus(scaling.offset / size, whole=False), Step("*", Factor(size, scaling.pi)))
    if _shifted_first(scaling):
        return (*_plus(scaling.offset / scaling.factor, whole=whole), *_times(scaling.factor, whole=whole))
    return (*_times(scaling.factor, whole=whole), *_plus(scaling.offset, whole=whole))


def steps_back(scaling: Scaling, *, whole: bool) -> tuple[Step, ...]:
    """Return the operations that invert a scaling. ``whole`` is true if an integer must stay one."""
    if scaling.pi:
        size = abs(scaling.factor)
        shifted = (Step("/", Factor(size, scaling.pi)), *_plus(-scaling.offset / size, whole=False))
        return (*shifted, Step("negate")) if scaling.factor < 0 else shifted
    if _shifted_first(scaling):
        return (*_by(scaling.factor, whole=whole), *_plus(-scaling.offset / scaling.factor, whole=whole))
    return (*_plus(-scaling.offset, whole=whole), *_by(scaling.factor, whole=whole))


def _times(factor: Fraction, *, whole: bool) -> tuple[Step, ...]:
    """Return the multiplication by a factor, with the operator whose result has the least rounding.

    It is ``x / 1.8`` for the factor 5/9, and ``-x / 1000.0`` for -1/1000. The number 1.8 has few digits, whereas
    0.5555... would be rounded.
    """
    size = abs(factor)
    negated = (Step("negate"),) if factor < 0 else ()
    if size == 1:
        return negated
    if size.denominator == 1:
        return (*negated, Step("*", size, whole))
    if size.numerator == 1 or (_is_decimal(1 / size) and not _is_decimal(size)):
        return (*negated, Step("/", 1 / size))
    if _is_decimal(size):
        return (*negated, Step("*", size))
    return (*negated, Step("*", Fraction(size.numerator)), Step("/", Fraction(size.denominator)))


def _by(factor: Fraction, *, whole: bool) -> tuple[Step, ...]:
    """Return the division by a factor. This is the inverse of `_times`."""
    if _is_decimal(factor) and abs(factor).numerator != 1:
        return (*((Step("negate"),) if factor < 0 else ()), Step("/", abs(factor)))
    return _times(1 / factor, whole=whole)


def _plus(offset: Fraction, *, whole: bool) -> tuple[Step, ...]:
    return (Step("-" if offset < 0 else "+", abs(offset), whole),) if offset else ()


def _applied(value: float, found: Iterable[Step]) -> float:
    for step in found:
        value = value * step.value if step.operator == "*" else value / step.value
    return value


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
        return self._spelled(text, steps(scaling, whole=whole), scaling)

    def back(self, text: str, scaling: Scaling, *, whole: bool) -> str:
        """Return the expression that inverts a scaling: it computes the original number from the scaled number.

        ``text`` is the expression of the scaled number. ``whole`` is true if the result must be an integer.
        """
        return self._spelled(text, steps_back(scaling, whole=whole), scaling)

    def _spelled(self, text: str, found: Iterable[Step], scaling: Scaling) -> str:
        is_sum = False
        for step in found:
            if is_sum and step.operator in ("negate", "*", "/"):
                text, is_sum = f"({text})", False
            if step.operator == "negate":
                text = f"-{text}"
                continue
            is_sum = step.operator in ("+", "-")
            operand = step.operand
            if isinstance(operand, Factor):
                text = f"{text} {step.operator} {self._constant(operand, scaling)}"
            else:
                text = f"{text} {step.operator} {self._dialect.number(operand, whole=step.whole)}"
        return text

    def _constant(self, factor: Factor, scaling: Scaling) -> str:
        """Return the name of the constant for a scaling that contains π. Add the constant to `constants`."""
        size, pi = factor.size, self._dialect.pi
        if factor.pi > 0:
            value = self._spelled(pi, _times(size, whole=True), scaling)
        else:
            value = f"{self._dialect.number(size, whole=True)} / {pi}"
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


def _word(unit: str) -> str:
    """Return a unit as a part of a constant's name: ``M_PER_S`` for ``m/s``."""
    return re.sub(r"\W+", "_", unit.replace("/", "_PER_").replace("%", "PERCENT")).strip("_").upper() or "1"
