"""What a state of a .proto file says about numbers. Thousands of states differ by a line, so each line is read once.

A file is cut where statements end. What a piece says depends on it and on the kind of block that it stands in alone,
and is remembered. Whatever is not as plain as that (conflict markers, braces without a partner, groups, aggregates)
goes to `parse` as a whole, which says the same and takes its time.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from generator.declarations import Enum, File, Message, parse
from generator.history.facts import facts_of
from generator.history.model import Fact
from generator.history.pieces import Piece, Pieces

# Between two marks, each part begins with what no other part may hold, so that there is one way to match, or none.
_NO_MARK = r"[^;{}\"'/]*"
_COMMENT = r"//[^\n]*(?![^\n])|/\*[^*]*(?:\*(?!/)[^*]*)*\*/"
_STRING = r"\"[^\"\\\n]*(?:\\.[^\"\\\n]*)*\"|'[^'\\\n]*(?:\\.[^'\\\n]*)*'"
_PIECE = re.compile(f"{_NO_MARK}(?:(?:{_COMMENT}|{_STRING}){_NO_MARK})*[;{{}}]")
_MARKER = re.compile(r"^(?:<{7}|={7}|>{7}|\|{7})", re.MULTILINE)
_DEEPEST = 32  # blocks in each other, as deep as `parse` reads


@dataclass(frozen=True, slots=True)
class Declaration:
    """A message or an enum in one state of a file."""

    facts: dict[Fact, int]
    """With the lines on which they stand."""
    line: int
    broken: bool
    """Whether the file has lines that cannot be read."""
    enum: bool


@dataclass(frozen=True, slots=True)
class Reading:
    """What one state of a file declares, by full names."""

    declarations: dict[str, Declaration] = field(default_factory=dict)
    broken: bool = False


class Reader:
    """Reads states of files, and remembers pieces."""

    def __init__(self) -> None:
        self._pieces: dict[str, Pieces] = {}

    def read(self, text: str) -> Reading:
        """What a file says, however broken it is."""
        return self.quick(text) or reading_of(parse(text))

    def quick(self, text: str) -> Reading | None:
        """The same, if the file is plain enough to be read piece by piece; None if not."""
        text = text.removeprefix("\ufeff")
        cut = _cut(text)
        return _Walk(self._pieces_in).run(cut) if cut is not None else None

    def _pieces_in(self, context: str) -> Pieces:
        found = self._pieces.get(context)
        if found is None:
            found = self._pieces[context] = Pieces(context)
        return found


def _cut(text: str) -> list[str] | None:
    """The text up to the end of each statement, and what is left; None where lines do not mean what they say."""
    if _MARKER.search(text):
        return None
    pieces, start = [], 0
    while match := _PIECE.match(text, start):
        pieces.append(match.group())
        start = match.end()
    return [*pieces, text[start:]]


class _Block:
    """A block that is open."""

    def __init__(self, pieces: Pieces, name: str, line: int, facts: dict[Fact, int]) -> None:
        self.pieces, self.name, self.line, self.facts = pieces, name, line, facts


class _Walk:
    """A walk over the pieces of one file."""

    def __init__(self, pieces_in: Callable[[str], Pieces]) -> None:
        self._pieces_in = pieces_in
        self._open = [_Block(pieces_in("file"), "", 1, {})]
        self._declared: dict[str, tuple[dict[Fact, int], int, bool]] = {}
        self._package, self._broken = "", False

    def run(self, cut: list[str]) -> Reading | None:
        """Read all of it; None where a piece is not plain, or a brace has no partner."""
        line = 1
        block = self._open[-1]
        for text in cut:
            piece = block.pieces.read(text)
            if piece is None:
                return None
            for offset, fact in piece.facts:
                block.facts.setdefault(fact, line + offset)
            if piece.effect and not self._take(piece, line):
                return None
            block = self._open[-1]
            line += piece.lines
        return self._reading() if len(self._open) == 1 else None

    def _take(self, piece: Piece, line: int) -> bool:
        """Take what a piece says beside facts; whether that is possible."""
        self._broken |= piece.broken
        self._package = piece.package or self._package
        if piece.closes:
            self._open.pop()
        elif piece.opens:
            self._enter(piece, line + piece.line)
        return 0 < len(self._open) <= _DEEPEST

    def _enter(self, piece: Piece, line: int) -> None:
        outer, pieces = self._open[-1], self._pieces_in(piece.opens)
        if not piece.name:  # a oneof's members are its message's; of a service, nothing is known
            self._open.append(_Block(pieces, outer.name, line, outer.facts))
            return
        name = f"{outer.name}.{piece.name}" if outer.name else piece.name
        facts = self._declared.setdefault(name, ({}, line, piece.opens == "enum"))[0]
        self._open.append(_Block(pieces, name, line, facts))

    def _reading(self) -> Reading:
        scope = f"{self._package}." if self._package else ""
        return Reading(
            {
                scope + name: Declaration(facts, line, self._broken, enum)
                for name, (facts, line, enum) in self._declared.items()
            },
            self._broken,
        )


def reading_of(file: File) -> Reading:
    """What a parsed file says about numbers."""
    declared: dict[str, Declaration] = {}
    types: list[Message | Enum] = [*file.all_messages(), *file.all_enums()]
    for type in sorted(types, key=lambda one: one.line):
        enum = isinstance(type, Enum)
        facts = declared.setdefault(type.full_name, Declaration({}, type.line, file.broken, enum)).facts
        for fact, line in facts_of(type):
            facts[fact] = min(facts.get(fact, line), line)
    return Reading(declared, file.broken)
