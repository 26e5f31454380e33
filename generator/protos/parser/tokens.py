"""A .proto file as tokens, each with its place and the comments before it. Everything is in some token or skipped."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from roverlink.generator.protos.parser.parsed_file import Problem

TAB_WIDTH = 8


class Kind(Enum):
    """What a token is."""

    NAME = "name"
    NUMBER = "number"
    STRING = "string"
    SYMBOL = "symbol"
    END = "end of file"


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment, by what stands between its marks."""

    start: int
    end: int
    line: int
    column: int
    """Where its text starts, behind the mark."""


class Token(NamedTuple):
    """A name, a number, a string or a single other character."""

    kind: Kind
    text: str
    start: int
    line: int
    column: int
    first: bool
    """Whether it is the first one on its line."""
    comments: tuple[Comment, ...]
    """Those between the previous token and this one."""
    cut_off: bool = False
    """Whether it is a string without an end."""

    @property
    def end(self) -> int:
        """The offset behind it."""
        return self.start + len(self.text)

    def is_symbol(self, text: str) -> bool:
        """Whether it is this character, and not a string that looks like it."""
        return self.kind is Kind.SYMBOL and self.text == text


class Place:
    """Line and column of an offset that only ever grows, so that all of them together cost one walk over the text."""

    def __init__(self, text: str, offset: int = 0, line: int = 1, column: int = 1) -> None:
        self._text, self._offset = text, offset
        self.line, self.column = line, column

    def move_to(self, offset: int) -> None:
        """Take the place of this offset."""
        passed = self._text[self._offset : offset]
        self._offset = offset
        if "\n" in passed:
            self.line, self.column = self.line + passed.count("\n"), 1
            passed = passed[passed.rfind("\n") + 1 :]
        if passed.isascii() and "\t" not in passed:
            self.column += len(passed)
        else:
            self._widen(passed)

    def _widen(self, passed: str) -> None:
        column = self.column - 1
        for char in passed:
            column += TAB_WIDTH - column % TAB_WIDTH if char == "\t" else len(char.encode("utf-8", "surrogatepass"))
        self.column = column + 1


# Tried at every offset, one of these fits, and none can come to a point at which it had to try again otherwise.
_PIECE = re.compile(
    r"[ \t\r\n\v\f]*(?:"
    r"(?P<name>[^\W\d]\w*)"
    r"|(?P<marker>^(?:<{7,}|={7,}|>{7,}|\|{7,})(?=\s|\Z)[^\n]*)"
    r"|(?P<line_comment>//[^\n]*)"
    r"|(?P<block_comment>/\*)"
    r"|(?P<number>\.?[0-9][\w.]*)"
    r"|(?P<string>\"[^\"\\\n]*(?:\\[^\n]?[^\"\\\n]*)*(?P<end>\")?|'[^'\\\n]*(?:\\[^\n]?[^'\\\n]*)*(?P<end_too>')?)"
    r"|(?P<unseen>[\x00-\x1f\x7f\ufeff\s])"
    r"|(?P<symbol>.)"
    r"|(?P<end_of_file>\Z))",
    re.MULTILINE,
)
_KINDS = {"name": Kind.NAME, "number": Kind.NUMBER, "symbol": Kind.SYMBOL}


class Lexer:
    """Cuts a text into tokens; what is none is skipped, and said to be so."""

    def __init__(self, text: str) -> None:
        self.tokens: list[Token] = []
        self.problems: list[Problem] = []
        self._text = text
        self._place = Place(text)
        self._line = 0
        """That of the last token."""
        self._comments: list[Comment] = []
        self._no_more: set[str] = set()
        """What is not in the rest of the text: to search for it again would cost the length of that again."""

    def run(self) -> None:
        """Fill `tokens`, of which the last one is the end of the file, and `problems`."""
        offset = 1 if self._text.startswith("\ufeff") else 0
        while match := _PIECE.match(self._text, offset):
            name = match.lastgroup or ""
            start, offset = match.span(name)
            text = self._text[start:offset]
            if kind := _KINDS.get(name):
                self._token(kind, text, start)
            elif name == "line_comment":
                self._comment(start + 2, offset)
            elif name == "block_comment":
                offset = self._block_comment(start)
            elif name == "string":
                self._token(Kind.STRING, text, start, not (match["end"] or match["end_too"]))
            elif name == "unseen":
                self._problem(start, f"a character that cannot be seen: {text!a}")
            elif name == "marker":
                offset = self._conflict_marker(text, start)
            else:
                self._token(Kind.END, "", start)
                return

    def _token(self, kind: Kind, text: str, start: int, cut_off: bool = False) -> None:
        place = self._place
        place.move_to(start)
        line = place.line
        comments: tuple[Comment, ...] = ()
        if self._comments:
            comments, self._comments = tuple(self._comments), []
        self.tokens.append(Token(kind, text, start, line, place.column, line != self._line, comments, cut_off))
        self._line = line
        if cut_off:
            self._problem(start, "a string that does not end on its line")
        elif kind is Kind.NAME and not text.isascii():
            self._problem(start, f"a name with other letters than those of ASCII: {text[:40]}")

    def _problem(self, offset: int, what: str) -> None:
        self._place.move_to(offset)
        self.problems.append(Problem(self._place.line, self._place.column, what))

    def _comment(self, start: int, end: int) -> None:
        self._place.move_to(start)
        self._comments.append(Comment(start, end, self._place.line, self._place.column))

    def _block_comment(self, start: int) -> int:
        """Take a comment and return its end; one that does not end is taken to end on its line.

        protoc would see nothing but it from there on.
        """
        end = self._find("*/", start + 2)
        if end >= 0:
            self._comment(start + 2, end)
            return end + 2
        self._problem(start, "a comment that does not end")
        line_end = self._text.find("\n", start + 2)
        end = line_end if line_end >= 0 else len(self._text)
        self._comment(start + 2, end)
        return end

    def _find(self, wanted: str, start: int) -> int:
        found = -1 if wanted in self._no_more else self._text.find(wanted, start)
        if found < 0:
            self._no_more.add(wanted)
        return found

    def _conflict_marker(self, marker: str, start: int) -> int:
        """Return where to read on behind a line that git put there.

        The common ancestor is skipped where git shows it, and neither of the two sides is.
        """
        self._problem(start, f"a conflict marker: {marker[:40].rstrip()}")
        sides = self._find("\n=======", start) if marker.startswith("|") else -1
        return start + len(marker) if sides < 0 else sides + 1
