"""Unit of measurement: its dimension, and its exact conversion to SI units."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from roverlink.generator.ir.interfaces import Scaling

BASES = ("m", "kg", "s", "A", "K", "mol", "cd", "rad")
"""Base units: those of the SI, and the radian, so that rad/s and Hz have different dimensions."""

Dimension = tuple[int, ...]
"""Exponent of each base unit in `BASES`: ``(1, 0, -2, 0, 0, 0, 0, 0)`` for m/s^2."""

DIMENSIONLESS: Dimension = (0,) * len(BASES)


@dataclass(frozen=True, slots=True)
class Unit:
    """Unit of measurement. A number in this unit equals number * ``factor`` * π**``pi`` + ``offset`` in SI units."""

    dimension: Dimension = DIMENSIONLESS
    factor: Fraction = Fraction(1)
    pi: int = 0
    offset: Fraction = Fraction(0)
    """Zero point of the unit's scale in SI units; only temperatures such as °C have another one than 0."""

    def __mul__(self, other: Unit) -> Unit:
        dimension = tuple(a + b for a, b in zip(self.dimension, other.dimension))
        return Unit(dimension, self.factor * other.factor, self.pi + other.pi)

    def __pow__(self, exponent: int) -> Unit:
        return Unit(tuple(part * exponent for part in self.dimension), self.factor**exponent, self.pi * exponent)

    def scaled(self, factor: Fraction) -> Unit:
        """Return the unit that is ``factor`` times as large as this one."""
        return Unit(self.dimension, self.factor * factor, self.pi)

    @property
    def in_si(self) -> str:
        """Dimension in SI notation, such as ``m s^-2``; ``1`` if it has none.

        >>> (Unit((1, 0, 0, 0, 0, 0, 0, 0)) * Unit((0, 0, 1, 0, 0, 0, 0, 0)) ** -2).in_si
        'm s^-2'
        """
        powers = [(name, exponent) for name, exponent in zip(BASES, self.dimension) if exponent]
        return " ".join(name if exponent == 1 else f"{name}^{exponent}" for name, exponent in powers) or "1"


def conversion(source: Unit, target: Unit) -> Scaling:
    """Return the factor and offset from the unit ``source`` to the unit ``target``, which has the same dimension."""
    factor = source.factor / target.factor
    return Scaling(factor, (source.offset - target.offset) / target.factor, source.pi - target.pi)
