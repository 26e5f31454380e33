"""What the tokens of one statement say: names, numbers, strings, ranges, options; each as far as it is there."""

from __future__ import annotations

import re
from collections.abc import Sequence

from roverlink.generator.protos.parser.tokens import Kind, Token

_DIGITS = re.compile(r"0[xX][0-9A-Fa-f]+|0[0-7]*|[1-9][0-9]*")
_LONGEST_NUMBER = 24  # of 64 bits in octal, with its zero; Python refuses, or takes long over, those of many thousands
_ESCAPE = re.compile(r"\\(?:([0-7]{1,3})|[xX]([0-9A-Fa-f]{1,2})|u([0-9A-Fa-f]{4})|U00([01][0-9A-Fa-f]{5})|(.?))")
_ESCAPED = {"a": "\a", "b": "\b", "f": "\f", "n": "\n", "r": "\r", "t": "\t", "v": "\v"}
_OPENING, _CLOSING = "[{(<", "]})>"

MAX = None
"""The end of a range that is written ``max``; what that is depends on where it stands."""
Range = tuple[int, int | None]


def number_of(text: str) -> int | None:
    """A decimal, hexadecimal or octal number; None where it is none."""
    if len(text) > _LONGEST_NUMBER or not _DIGITS.fullmatch(text):
        return None
    if text[1:2] in ("x", "X"):
        return int(text[2:], 16)
    return int(text, 8 if text.startswith("0") else 10)


def string_of(literal: str) -> str:
    """What a string literal stands for, be it closed or not."""
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
    """A walk over the tokens of a statement. What is not there is empty, or None, and not taken."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self._tokens, self._at = tokens, 0
        self.closed = True
        """Whether no bracket was seen that nothing closes."""

    def next(self, ahead: int = 0) -> Token:
        """The next token, or the one ``ahead`` of it; behind the last one, a token without text."""
        try:
            return self._tokens[self._at + ahead]
        except IndexError:
            return _NOTHING

    @property
    def done(self) -> bool:
        """Whether no token is left."""
        return self._at >= len(self._tokens)

    def skip(self) -> Token:
        """Take the next token, whatever it is."""
        token = self.next()
        self._at += 1
        return token

    def take(self, *texts: str) -> str:
        """The next token's text if it is one of these."""
        token = self.next()
        if token.text not in texts or token.kind is Kind.STRING:
            return ""
        self._at += 1
        return token.text

    def name(self) -> str:
        """A name without dots."""
        token = self.next()
        if token.kind is not Kind.NAME:
            return ""
        self._at += 1
        return token.text

    def type_name(self) -> str:
        """A name of parts with dots between them, and perhaps one before."""
        name = self.take(".") + (last := self.name())
        while last and self.next().is_symbol(".") and self.next(1).kind is Kind.NAME:
            name += self.skip().text + (last := self.name())
        return name

    def number(self, signed: bool = False) -> int | None:
        """An integer, which may be negative if it is ``signed``; one that cannot be read is taken and None."""
        minus = self.take("-")
        number = number_of(self.skip().text) if self.next().kind is Kind.NUMBER else None
        if number is None or (minus and not signed):
            return None
        return -number if minus else number

    def string(self) -> str | None:
        """A string; several next to each other are one."""
        parts = []
        while self.next().kind is Kind.STRING:
            parts.append(string_of(self.skip().text))
        return "".join(parts) if parts else None

    def map_types(self) -> tuple[str, str]:
        """Key and value of ``map<K, V>``; empty where it is something else."""
        if self.next().text != "map" or not self.next(1).is_symbol("<"):
            return "", ""
        self._at += 2
        key, _ = self.type_name(), self.take(",")
        value, _ = self.type_name(), self.take(">")
        return key, value

    def ranges(self, signed: bool) -> tuple[list[Range], list[str]]:
        """Numbers, ranges of numbers, and names or strings, with commas between them."""
        ranges: list[Range] = []
        names: list[str] = []
        while not self.done:
            if (name := self.string() or self.name()) != "":
                names.append(name)
            elif (start := self.number(signed)) is not None:
                end = self._range_end(start, signed)
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

    def skip_brackets(self) -> None:
        """Take the options in brackets, if any are next."""
        if not self.take("["):
            return
        while not self.done and not self.next().is_symbol("]"):
            self.option(",")
            if not self.take(","):
                break
        self.closed = bool(self.take("]"))

    def option(self, end: str = "") -> tuple[str, str]:
        """An option's name and value, without spaces, up to one of the characters ``end`` that is in no bracket."""
        name = "".join(token.text for token in self._up_to("=" + end))
        value = self._up_to(end) if self.take("=") else []
        return name, "".join(token.text for token in value)

    def _up_to(self, ends: str) -> list[Token]:
        """Tokens up to one of these characters, or up to a bracket that closes what was not opened here."""
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
