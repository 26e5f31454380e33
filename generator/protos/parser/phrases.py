"""Reader for the parts of a statement: names, numbers, strings, ranges, options. A missing part raises no error."""

from __future__ import annotations

import re
from collections.abc import Sequence

from roverlink.generator.protos.parser.tokens import Kind, Token

# The integers of protobuf's grammar (Language Specification, "Integer literals"): hexadecimal, octal with a leading 0,
# decimal. Python's int() would accept `1_000`, and read `010` as ten.
_DIGITS = re.compile(r"0[xX][0-9A-Fa-f]+|0[0-7]*|[1-9][0-9]*")
_LONGEST_NUMBER = (
    24  # 64 bits in octal have 23 digits; Python is slow with thousands of digits, and refuses more than 4,300
)
# The escapes of string literals (Language Specification, "String literals"). \U goes up to U+10FFFF, the last code
# point.
_ESCAPE = re.compile(r"\\(?:([0-7]{1,3})|[xX]([0-9A-Fa-f]{1,2})|u([0-9A-Fa-f]{4})|U00([01][0-9A-Fa-f]{5})|(.?))")
_ESCAPED = {"a": "\a", "b": "\b", "f": "\f", "n": "\n", "r": "\r", "t": "\t", "v": "\v"}
_OPENING, _CLOSING = "[{(<", "]})>"

MAX = None
"""The end of a range that is written as ``max``. Its number depends on the kind of block: a message or an enum."""
Range = tuple[int, int | None]


def number_of(text: str) -> int | None:
    """Convert the text of an integer (decimal, hexadecimal or octal) to a number; None if it is not an integer."""
    if len(text) > _LONGEST_NUMBER or not _DIGITS.fullmatch(text):
        return None
    if text[1:2] in ("x", "X"):
        return int(text[2:], 16)
    return int(text, 8 if text.startswith("0") else 10)


def string_of(literal: str) -> str:
    """Return the value of a string literal without quotes and escapes, even if its closing quote is missing."""
    quote = literal[:1]
    inner = literal[1:-1] if len(literal) > 1 and literal.endswith(quote) else literal[1:]
    return _ESCAPE.sub(_unescape, inner) if "\\" in inner else inner


def _unescape(match: re.Match[str]) -> str:
    octal, short, medium, long, other = match.groups()
    if other is not None:
        return _ESCAPED.get(other, other)
    code = int(octal, 8) if octal else int(short or medium or long, 16)
    return chr(min(code, 0x10FFFF))


_NOTHING = Token(Kind.END, "", 0, 0, 0, False, ())


class Words:
    """Reader of a statement's tokens, one part after another.

    If a part is missing, its method returns an empty text or None, and takes no token.
    """

    def __init__(self, tokens: Sequence[Token]) -> None:
        self._tokens, self._at = tokens, 0
        self.closed = True
        """False if a bracket of the statement is not closed."""

    def next(self, ahead: int = 0) -> Token:
        """Return the next token without taking it, or the token that is ``ahead`` tokens further.

        After the last token, this is a token without text.
        """
        try:
            return self._tokens[self._at + ahead]
        except IndexError:
            return _NOTHING

    @property
    def done(self) -> bool:
        """True if no token is left."""
        return self._at >= len(self._tokens)

    def skip(self) -> Token:
        """Take and return the next token, whatever it is."""
        token = self.next()
        self._at += 1
        return token

    def take(self, *texts: str) -> str:
        """Take the next token if its text is one of ``texts``. Returns the text; empty if no token was taken."""
        token = self.next()
        if token.text not in texts or token.kind is Kind.STRING:
            return ""
        self._at += 1
        return token.text

    def name(self) -> str:
        """Take and return a name without dots. Returns an empty text if there is none."""
        token = self.next()
        if token.kind is not Kind.NAME:
            return ""
        self._at += 1
        return token.text

    def type_name(self) -> str:
        """Take and return a type's name, which may contain dots and start with one: ``.rover.Imu``.

        Returns an empty text if there is none.
        """
        name = self.take(".") + (last := self.name())
        while last and self.next().is_symbol(".") and self.next(1).kind is Kind.NAME:
            name += self.skip().text + (last := self.name())
        return name

    def number(self, signed: bool = False) -> int | None:
        """Take and return an integer; None if it is malformed, missing, or negative without ``signed``."""
        minus = self.take("-")
        number = number_of(self.skip().text) if self.next().kind is Kind.NUMBER else None
        if number is None or (minus and not signed):
            return None
        return -number if minus else number

    def string(self) -> str | None:
        """Take a string and return its value; None if there is none. Adjacent literals form one string, as in C."""
        parts = []
        while self.next().kind is Kind.STRING:
            parts.append(string_of(self.skip().text))
        return "".join(parts) if parts else None

    def map_types(self) -> tuple[str, str]:
        """Take the type ``map<K, V>``. Returns the texts ``K`` and ``V``; both are empty if the type is not a map."""
        if self.next().text != "map" or not self.next(1).is_symbol("<"):
            return "", ""
        self._at += 2
        key, _ = self.type_name(), self.take(",")
        value, _ = self.type_name(), self.take(">")
        return key, value

    def ranges(self, signed: bool) -> tuple[list[Range], list[str]]:
        """Take the list of a ``reserved`` or ``extensions`` statement: ``4, 8 to max`` or ``"old_name"``.

        Returns the ranges and the names; a single number is a range whose ends are equal.
        """
        ranges: list[Range] = []
        names: list[str] = []
        while not self.done:
            if (name := self.string() or self.name()) != "":
                names.append(name)
            elif (start := self.number(signed)) is not None:
                end = self._range_end(start, signed)
                # protoc rejects such a range. Both ends were meant, so the numbers between them count as reserved.
                if end is not MAX and end < start:
                    start, end = end, start
                ranges.append((start, end))
            if not self.take(","):
                break
        return ranges, names

    def _range_end(self, start: int, signed: bool) -> int | None:
        if not self.take("to"):
            return start
        if self.take("max"):
            return MAX
        end = self.number(signed)
        return start if end is None else end

    def bracketed_options(self) -> dict[str, Words]:
        """Take the options in brackets, if the statement has any: ``[deprecated = true]``. Returns values by name."""
        options: dict[str, Words] = {}
        if not self.take("["):
            return options
        while not self.done and not self.next().is_symbol("]"):
            name, value = self._option(",")
            options[name] = Words(value)
            if not self.take(","):
                break
        self.closed = bool(self.take("]"))
        return options

    def option(self) -> tuple[str, str]:
        """Take an option such as ``deprecated = true``. Returns the texts of its name and value, without spaces."""
        name, value = self._option("")
        return name, "".join(token.text for token in value)

    def _option(self, end: str) -> tuple[str, list[Token]]:
        """Take an option. It ends before one of the characters in ``end``, unless that stands inside brackets."""
        name = "".join(token.text for token in self._up_to("=" + end))
        return name, self._up_to(end) if self.take("=") else []

    def _up_to(self, ends: str) -> list[Token]:
        """Take tokens until one of the characters ``ends`` follows, or a bracket that closes an outer one."""
        taken: list[Token] = []
        depth = 0
        while not self.done:
            token = self.next()
            symbol = token.text if token.kind is Kind.SYMBOL else "\0"
            if depth == 0 and (symbol in ends or symbol in "]})"):
                break
            depth += (symbol in _OPENING) - (symbol in _CLOSING and depth > 0)
            taken.append(self.skip())
        return taken
