"""The tokens of a .proto file, and the lexer that cuts the text into tokens.

Each token knows its place and the comments before it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from roverlink.generator.protos.parser.parsed_file import Problem

# The tab width of protoc's tokenizer. The places of both readers have to be the same.
TAB_WIDTH = 8


class Kind(Enum):
    """The kind of a token."""

    NAME = "name"
    NUMBER = "number"
    STRING = "string"
    SYMBOL = "symbol"
    END = "end of file"


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment. Its text, without ``//`` or ``/*``, reaches from the offset ``start`` to the offset ``end``."""

    start: int
    end: int
    line: int
    column: int
    """Column at which the text of the comment begins, after ``//`` or ``/*``."""


class Token(NamedTuple):
    """A token: a name, a number, a string or another single character."""

    kind: Kind
    text: str
    start: int
    line: int
    column: int
    first: bool
    """True if the token is the first one in its line."""
    comments: tuple[Comment, ...]
    """The comments between the previous token and this one."""
    cut_off: bool = False
    """True for a string whose closing quote is missing."""

    @property
    def end(self) -> int:
        """The offset in the text after the token's last character."""
        return self.start + len(self.text)

    def is_symbol(self, text: str) -> bool:
        """Return True if the token is this character, and not a string with the same text."""
        return self.kind is Kind.SYMBOL and self.text == text


class Place:
    """Converter of an offset in the text to line and column. The offset may only grow, so the text is read once."""

    def __init__(self, text: str, offset: int = 0, line: int = 1, column: int = 1) -> None:
        self._text, self._offset = text, offset
        self.line, self.column = line, column

    def move_to(self, offset: int) -> None:
        """Change the offset to a larger one, and compute its line and column."""
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


# At every offset one alternative matches, and none of them backtracks. So time is linear in the length of any text.
# - marker: git marks a conflict with at least seven of these characters at the beginning of a line (gitattributes(5),
#   conflict-marker-size). It stands before `symbol`, which would take each character by itself.
# - number: looser than protobuf's grammar, which `number_of` applies. `4x` becomes one token, not a number and a name.
# - string: ends with its line at the latest, because an unclosed quote must not swallow the rest of the file.
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
    """Lexer: cuts a text into tokens. Characters that belong to no token are reported and skipped."""

    def __init__(self, text: str) -> None:
        self.tokens: list[Token] = []
        self.problems: list[Problem] = []
        self._text = text
        self._place = Place(text)
        self._line = 0
        """Line of the last token that was found."""
        self._comments: list[Comment] = []
        self._no_more: set[str] = set()
        """Texts, such as ``*/``, that do not occur in the rest of the file.

        Without this set, a file with many unclosed comments would take quadratic time.
        """

    def run(self) -> None:
        """Fill the lists `tokens` and `problems`. The last token stands for the end of the file."""
        # The byte order mark that some editors write; protoc skips it, too.
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
                self._problem(start, f"an invisible character: {text!a}")
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
            self._problem(start, f"a name with letters outside of ASCII: {text[:40]}")

    def _problem(self, offset: int, what: str) -> None:
        self._place.move_to(offset)
        self.problems.append(Problem(self._place.line, self._place.column, what))

    def _comment(self, start: int, end: int) -> None:
        self._place.move_to(start)
        self._comments.append(Comment(start, end, self._place.line, self._place.column))

    def _block_comment(self, start: int) -> int:
        """Take a block comment and return the offset of its end. An unclosed comment ends with its line.

        protoc would read the rest of the file as a part of the comment.
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
        """Return the offset at which reading continues after a conflict marker of git.

        Both sides of the conflict are read. The common ancestor, which git writes with ``merge.conflictStyle=diff3``,
        is skipped.
        """
        self._problem(start, f"a conflict marker: {marker[:40].rstrip()}")
        # `|||||||` starts the common ancestor, which is neither side's state; it ends at `=======`.
        sides = self._find("\n=======", start) if marker.startswith("|") else -1
        return start + len(marker) if sides < 0 else sides + 1
