"""The units that a mapping may name agree with pint, which knows them from elsewhere."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.generator.resolve import units
from roverlink.generator.resolve.units import known
from roverlink.generator.resolve.units.unit import BASES, Unit

if TYPE_CHECKING:
    import pint

_SPELLED = """
1=dimensionless %=percent °=degree g0=standard_gravity C=coulomb rpm=revolution/minute h=hour d=day min=minute
t=metric_ton rev=revolution lbf=pound_force lb=pound in=inch ft=foot mi=mile nmi=nautical_mile kn=knot degC=degC
°C=degC degF=degF °F=degF Ω=ohm deg=degree lm=lumen lx=lux Wh=watt_hour Ah=ampere_hour ohm=ohm arcmin=arcminute
arcsec=arcsecond L=liter H=henry F=farad T=tesla bar=bar ppm=ppm
"""
_THEIRS = dict(pair.split("=") for pair in _SPELLED.split())
_PREFIXES = {"u": "micro", "µ": "micro", "μ": "micro", "da": "deca", "h": "hecto", "d": "deci", "c": "centi"}
_PREFIXES |= {"k": "kilo", "M": "mega", "G": "giga", "m": "milli", "n": "nano"}
_DIMENSIONS = dict(zip(BASES, ("meter", "kilogram", "second", "ampere", "kelvin", "mole", "candela", "radian")))


@cache
def _pint() -> pint.UnitRegistry[float]:
    """Pint's registry, which takes a second to make: made where it is needed, not where tests are collected."""
    import pint

    return pint.UnitRegistry()


def _agree(ours: Unit, theirs: str, number: float = 12.5) -> None:
    """A number in our unit is the same in SI units as one in theirs, and of the same dimension but for angles."""
    registry = _pint()
    quantity = registry.Quantity(number, theirs).to_base_units()
    dimension = registry.Unit("dimensionless")
    for base, exponent in zip(BASES, ours.dimension):
        if exponent:
            dimension *= registry.Unit(_DIMENSIONS[base]) ** exponent
    assert quantity.check((1 * dimension).dimensionality)
    assert quantity.to(dimension).magnitude == pytest.approx(
        float(number * ours.factor) * math.pi**ours.pi + float(ours.offset), rel=1e-12
    )


@pytest.mark.parametrize("symbol", sorted({*known.symbols()} - {"G"}))  # pint's G is of another system
def test_every_unit_is_the_one_that_pint_knows(symbol: str) -> None:
    """A unit without a prefix has pint's size, zero and dimension."""
    _agree(units.parse(symbol), _THEIRS.get(symbol, symbol))


@given(st.sampled_from(sorted({*known.PREFIXED} - {"G"})), st.sampled_from(sorted(_PREFIXES)))
@settings(max_examples=50)
def test_prefixes_are_those_of_the_si(symbol: str, prefix: str) -> None:
    """A unit behind a prefix has pint's size, where no other unit has that name."""
    if prefix + symbol not in (*known.PLAIN, *known.PREFIXED):
        _agree(units.parse(prefix + symbol), f"{_PREFIXES[prefix]}{_THEIRS.get(symbol, symbol)}")


_FACTORS = st.sampled_from(["m", "kg", "s", "deg", "uT", "kPa", "rad", "N", "V", "mA", "h", "km", "lx", "rpm"])


@given(st.lists(st.tuples(_FACTORS, st.integers(-3, 3), st.booleans()), min_size=1, max_size=4))
@settings(max_examples=50)
def test_products_and_powers_are_read_as_pint_reads_them(parts: list[tuple[str, int, bool]]) -> None:
    """Factors, divisors and powers, from left to right, are the unit that pint makes of them."""
    ours = theirs = "1"
    for symbol, power, divided in parts:
        sign = "/" if divided else "*"
        ours += f" {sign} {symbol}^{power}"
        spelled = {"uT": "microtesla", "kPa": "kilopascal", "mA": "milliampere"}.get(symbol, symbol)
        if power:  # pint stumbles over the power 0 of some
            theirs += f" {sign} ({_THEIRS.get(symbol, spelled)}) ** {power}"
    _agree(units.parse(ours), theirs)


_WAYS = ["m/s^2 == m s-2", "m/s² == m*s**-2", "N·m == kg m^2/s^2", "(m/s)^2 == m^2/s^2", "µT == uT", "m/s2 == m/s^2"]


@pytest.mark.parametrize("ways", _WAYS)
def test_a_unit_can_be_written_in_several_ways(ways: str) -> None:
    """Products, powers and micro may be written as people write them."""
    one, other = ways.split(" == ")
    assert units.parse(one) == units.parse(other)
