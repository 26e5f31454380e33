"""Blocks of a .proto file. A block is the text between two braces; each kind of block reads its own statements."""

from __future__ import annotations

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.parser.commented_out import claimed_values
from roverlink.generator.protos.parser.field_statements import read_value
from roverlink.generator.protos.parser.parsed_file import LARGEST_ENUM_NUMBER
from roverlink.generator.protos.parser.phrases import MAX, Range, Words
from roverlink.generator.protos.parser.source_text import Source
from roverlink.generator.protos.parser.statements import VISIBILITIES, Statement
from roverlink.generator.protos.parser.tokens import Comment
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue


class Block:
    """A block of a .proto file, while its statements are being read."""

    def __init__(self, source: Source, opening: Statement) -> None:
        first = opening.tokens[0] if opening.tokens else source.tokens[opening.end]
        visibility = first.text in VISIBILITIES and len(opening.tokens) > 1
        self.source = source
        # protoc gives `export message X` the place of the word `message`.
        self.opening = opening.tokens[1] if visibility else first
        # 0 means unknown: a block that opens in the middle of a line tells nothing about the column of its closing
        # brace.
        self.indentation = first.column if first.first else 0
        self.unclosed = opening.end in source.tokens.unclosed
        self.depth = 0
        """In a `SkippedBlock`, the number of blocks that are open inside it."""

    @property
    def span(self) -> Span:
        """The place of the block's first token. Its file name is empty, because the parser does not know it."""
        return Span("", self.opening.line, self.opening.column)

    def take(self, statement: Statement) -> Block | None:
        """Read the next statement of the block.

        Returns the inner block that the statement opens; None if there is none.
        """
        if statement.tokens:
            return self.read(statement)
        return self.unknown(statement) if statement.ending == "{" else None

    def read(self, statement: Statement) -> Block | None:
        """Read a statement that has tokens. Returns the inner block that the statement opens; None if there is none.

        `take` calls this for every statement that is not just a brace or a semicolon. Each kind of block implements it.
        """
        raise NotImplementedError

    def unknown(self, statement: Statement) -> Block | None:
        """Report a block of an unknown kind.

        Returns a block that skips its content; None if the opening brace seems to be there by mistake. This is so for a
        brace in the middle of a line, in a file with unclosed braces.
        """
        self.source.unreadable(statement, "a block of an unknown kind")
        tokens = self.source.tokens
        ends_line = tokens[statement.end + 1].first
        return SkippedBlock(self.source, statement) if ends_line or not tokens.unclosed else None

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Find commented-out declarations in comments of the block. This base class ignores the comments.

        The parser calls this before each statement, with the comments of that statement.
        """


class SkippedBlock(Block):
    """A block whose content is skipped: a service, or a block of an unknown kind."""

    def take(self, statement: Statement) -> Block | None:
        """Skip a statement. If it opens an inner block, count it, so that its closing brace does not end this block."""
        self.depth += statement.ending == "{"
        return None


class EnumBlock(Block):
    """The content of an enum."""

    def __init__(self, source: Source, opening: Statement, name: str) -> None:
        super().__init__(source, opening)
        self.name = name
        self.values: list[ProtoEnumValue] = []
        self.reserved: list[Range] = []
        self.reserved_names: list[str] = []
        self.claims: list[ProtoEnumValue] = []

    def read(self, statement: Statement) -> Block | None:
        """Read an enum value, an option, or a ``reserved`` statement of the enum."""
        head = statement.tokens[0].text if len(statement.tokens) > 1 and statement.tokens[1].text != "=" else ""
        if head == "option":
            read_option(self.source, statement)
        elif head == "reserved":
            # Numbers of enum values are int32 and may be negative; field numbers may not.
            read_ranges(self.source, statement, self.reserved, self.reserved_names, signed=True)
        elif value := read_value(self.source, statement):
            self.values.append(value)
        return SkippedBlock(self.source, statement) if statement.ending == "{" else None

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Find commented-out enum values in comments of the enum."""
        self.claims += claimed_values(self.source.text, comments)

    def build(self, scope: str) -> ProtoEnum:
        """Return the enum that was read; ``scope`` is the package or message that contains the enum."""
        return ProtoEnum(
            span=self.span,
            full_name=f"{scope}.{self.name}" if scope else self.name,
            values=tuple(self.values),
            reserved=with_end(self.reserved, LARGEST_ENUM_NUMBER),
            reserved_names=tuple(self.reserved_names),
            claims=tuple(self.claims),
        )


# --- statements that several kinds of block have ------------------------------------------------------------------


def read_option(source: Source, statement: Statement) -> tuple[str, str]:
    """Read an ``option`` statement, and return the option's name and value."""
    words = Words(statement.tokens)
    words.skip()
    name, value = words.option()
    if not (name and value and statement.ending):
        source.unreadable(statement, "an option with wrong syntax")
    return name, value


def read_ranges(
    source: Source, statement: Statement, ranges: list[Range], names: list[str], signed: bool = False
) -> None:
    """Read a ``reserved`` or ``extensions`` statement, and add its content to ``ranges`` and ``names``.

    ``signed`` is true for enums, whose numbers may be negative.
    """
    words = Words(statement.tokens)
    words.skip()
    found_ranges, found_names = words.ranges(signed)
    ranges += found_ranges
    names += found_names
    words.bracketed_options()
    if not (words.done and words.closed and statement.ending and (found_ranges or found_names)):
        source.unreadable(statement, "numbers or names with wrong syntax")


def with_end(ranges: list[Range], largest: int) -> tuple[tuple[int, int], ...]:
    """Return the ranges with the end ``max`` replaced by the number ``largest``."""
    return tuple((start, largest if end is MAX else end) for start, end in ranges)
