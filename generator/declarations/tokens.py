"""A .proto file as tokens, each with its place and the comments before it. Everything is in some token or skipped."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

from generator.declarations.model import Problem

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

    block: bool
    start: int
    end: int
    line: int
    column: int
    """Where its text starts, behind the mark."""
    end_line: int


@dataclass(frozen=True, slots=True)
class Token:
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
        if lines := passed.count("\n"):
            self.line, self.column = self.line + lines, 1
            passed = passed[passed.rfind("\n") + 1 :]
        self.column += self._width(passed)

    def _width(self, passed: str) -> int:
        if passed.isascii() and "\t" not in passed:
            return len(passed)
        column = self.column - 1
        for char in passed:
            column += TAB_WIDTH - column % TAB_WIDTH if char == "\t" else len(char.encode("utf-8", "surrogatepass"))
        return column - (self.column - 1)


# Tried at every offset, one of these fits, and none can come to a point at which it had to try again otherwise.
_PIECE = re.compile(
    r"(?P<space>[ \t\r\n\v\f]+)"
    r"|(?P<line_comment>//[^\n]*)"
    r"|(?P<block_comment>/\*)"
    r"|(?P<name>[^\W\d]\w*)"
    r"|(?P<number>\.?[0-9][\w.]*)"
    r"|(?P<string>\"[^\"\\\n]*(?:\\[^\n]?[^\"\\\n]*)*(?P<end>\")?|'[^'\\\n]*(?:\\[^\n]?[^'\\\n]*)*(?P<end_too>')?)"
    r"|(?P<unseen>[\x00-\x1f\x7f\ufeff\s])"
    r"|(?P<symbol>.)"
)
_MARKER = re.compile(r"(?:<{7,}|={7,}|>{7,}|\|{7,})(?=\s|\Z)[^\n]*")


class Lexer:
    """Cuts a text into tokens; what is none is skipped, and said to be so."""

    def __init__(self, text: str) -> None:
        self.tokens: list[Token] = []
        self.problems: list[Problem] = []
        self._text = text
        self._offset = 0
        self._place = Place(text)
        self._comments: list[Comment] = []
        self._no_more: set[str] = set()
        """What is not in the rest of the text: to search for it again would cost the length of that again."""

    def run(self) -> None:
        """Fill `tokens`, of which the last one is the end of the file, and `problems`."""
        self._offset = 1 if self._text.startswith("\ufeff") else 0
        while self._offset < len(self._text):
            if not self._skip_conflict_marker():
                self._piece()
        self._token(Kind.END, "")

    def _piece(self) -> None:
        match = _PIECE.match(self._text, self._offset)
        assert match is not None, "one of its alternatives takes any character"  # noqa: S101  # for mypy
        kind, piece = match.lastgroup, match.group()
        if kind == "block_comment":
            self._block_comment()
            return
        if kind == "line_comment":
            self._comment(False, self._offset + 2, match.end())
        elif kind == "unseen":
            self._problem(f"a character that cannot be seen: {piece!a}")
        elif kind != "space":
            self._token(Kind(kind), piece, kind == "string" and not (match["end"] or match["end_too"]))
        self._offset = match.end()

    def _token(self, kind: Kind, text: str, cut_off: bool = False) -> None:
        self._place.move_to(self._offset)
        line, column = self._place.line, self._place.column
        first = not self.tokens or self.tokens[-1].line != line
        self.tokens.append(Token(kind, text, self._offset, line, column, first, tuple(self._comments), cut_off))
        self._comments = []
        if cut_off:
            self._problem("a string that does not end on its line")
        elif kind is Kind.NAME and not text.isascii():
            self._problem(f"a name with other letters than those of ASCII: {text[:40]}")

    def _problem(self, what: str) -> None:
        self._place.move_to(self._offset)
        self.problems.append(Problem(self._place.line, self._place.column, what))

    def _comment(self, block: bool, start: int, end: int) -> None:
        self._place.move_to(start)
        line, column = self._place.line, self._place.column
        self._comments.append(Comment(block, start, end, line, column, line + self._text.count("\n", start, end)))

    def _block_comment(self) -> None:
        """A comment that does not end is taken to end on its line: protoc would see nothing but it from there on."""
        start, end = self._offset + 2, self._find("*/", self._offset + 2)
        if end >= 0:
            self._comment(True, start, end)
            self._offset = end + 2
            return
        self._problem("a comment that does not end")
        line_end = self._text.find("\n", start)
        self._offset = line_end if line_end >= 0 else len(self._text)
        self._comment(True, start, self._offset)

    def _find(self, wanted: str, start: int) -> int:
        found = -1 if wanted in self._no_more else self._text.find(wanted, start)
        if found < 0:
            self._no_more.add(wanted)
        return found

    def _skip_conflict_marker(self) -> bool:
        """Skip a line that git put there, and the common ancestor where it shows that, but neither of the two sides."""
        start = self._offset
        if self._text[start] not in "<=>|" or (start and self._text[start - 1] != "\n"):
            return False
        match = _MARKER.match(self._text, start)
        if match is None:
            return False
        self._problem(f"a conflict marker: {match.group()[:40].rstrip()}")
        sides = self._find("\n=======", start) if match.group().startswith("|") else -1
        self._offset = match.end() if sides < 0 else sides + 1
        return True
