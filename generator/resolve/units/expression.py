"""Parser of unit expressions: symbols joined by ``*``, ``/`` and powers, from left to right, as in ``kg*m/s^2``."""

from __future__ import annotations

import re
from functools import cache

from roverlink.generator.resolve.units import known
from roverlink.generator.resolve.units.unit import Unit
from roverlink.suggestions import nearest

# The grammar, in which a product is read from left to right:
#
#     product = power { [ "*" | "·" | "/" ] power }
#     power   = atom [ [ "^" | "**" ] integer ]
#     atom    = symbol | "1" | "(" product ")"
#
# So `W/m^2 K` is (W/m^2) K. The SI brochure (section 5.2) asks for brackets instead of such a line: `W/(m^2 K)`.
#
# A minus sign is part of a number, since units have no subtraction. The 0 behind letters is for `g0` only.
_TOKEN = re.compile(r"\s*(\*\*|[*/^()·]|-?\d+|%|[^\W\d_]+0?(?![^\W\d_])|°[CF]?)")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_RAISED = re.compile(r"[⁻⁰¹²³⁴-⁹]+")
# No unit has a larger power; without a limit, `m^999999999` would compute for minutes.
_LARGEST_POWER = 12


class UnitError(ValueError):
    """Raised for a text that is not a unit; the message of the exception tells why."""


@cache
def parse(text: str) -> Unit:
    """Return the unit of an expression. Raises `UnitError` if it is not a unit.

    >>> parse("m/s^2").in_si
    'm s^-2'
    """
    tokens = _tokens(_RAISED.sub(lambda match: f"^{match[0].translate(_SUPERSCRIPTS)}", text))
    reader = _Reader(text, tokens)
    unit = reader.product()
    if reader.tokens:
        raise UnitError(f"{text!r} is not a unit: unexpected {reader.tokens[0]!r}")
    return unit


def _tokens(text: str) -> list[str]:
    tokens, position = [], 0
    while text[position:].strip():
        match = _TOKEN.match(text, position)
        if match is None:
            raise UnitError(f"{text!r} is not a unit: unexpected {text[position:].strip()[0]!r}")
        tokens.append(match[1])
        position = match.end()
    if not tokens:
        raise UnitError("an empty text is not a unit; write 1 for a number without a unit")
    return tokens


class _Reader:
    """Recursive-descent parser of a unit expression."""

    def __init__(self, text: str, tokens: list[str]) -> None:
        self._text, self.tokens, self._alone = text, tokens, len(tokens) == 1

    def product(self) -> Unit:
        """Parse a product or quotient of units, and return its unit.

        Two units side by side are multiplied, as in ``N m``.
        """
        unit = self._power()
        while self.tokens and self.tokens[0] != ")":
            sign = self.tokens.pop(0) if self.tokens[0] in ("*", "/", "·") else "*"
            other = self._power()
            unit *= other**-1 if sign == "/" else other
        return unit

    def _power(self) -> Unit:
        unit = self._atom()
        if self.tokens and (self.tokens[0] in ("^", "**") or self.tokens[0].lstrip("-").isdigit()):
            if self.tokens[0] in ("^", "**"):
                self.tokens.pop(0)
            exponent = self._next()
            if not exponent.lstrip("-").isdigit() or abs(int(exponent)) > _LARGEST_POWER:
                raise UnitError(f"{self._text!r} is not a unit: {exponent!r} is not a valid power")
            unit **= int(exponent)
        return unit

    def _atom(self) -> Unit:
        token = self._next()
        if token == "(":
            unit = self.product()
            if self._next() != ")":
                raise UnitError(f"{self._text!r} is not a unit: a bracket is not closed")
            return unit
        found = known.unit(token)
        if found is None:
            raise UnitError(f"unknown unit {token!r}; {nearest(token, known.symbols(), _EXAMPLES)}")
        # 20 degC is 293.15 K, but 20 degC/s is 20 K/s: an offset makes sense for a whole unit only.
        if found.offset and not self._alone:
            raise UnitError(
                f"the unit {token!r} has its own zero, so it cannot be combined with others; write K for differences"
            )
        return found

    def _next(self) -> str:
        if not self.tokens:
            raise UnitError(f"{self._text!r} is not a unit: it ends too early")
        return self.tokens.pop(0)


_EXAMPLES = "examples: m, deg/s, kPa, uT, degC, m/s^2, 1"
