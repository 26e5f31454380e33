"""What stands between braces: each kind of block reads its own statements, and may open a block inside."""

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
    """A block while it is read."""

    def __init__(self, source: Source, opening: Statement) -> None:
        first = opening.tokens[0] if opening.tokens else source.tokens[opening.end]
        visibility = first.text in VISIBILITIES and len(opening.tokens) > 1
        self.source = source
        self.opening = opening.tokens[1] if visibility else first  # as protoc has it
        self.indentation = first.column if first.first else 0
        self.unclosed = opening.end in source.tokens.unclosed
        self.depth = 0
        """How many blocks are open in a `SkippedBlock`."""

    @property
    def span(self) -> Span:
        """The place of its beginning, in a file that only the caller knows."""
        return Span("", self.opening.line, self.opening.column)

    def take(self, statement: Statement) -> Block | None:
        """Read a statement; the block that it opens, if it does."""
        if statement.tokens:
            return self.read(statement)
        return self.unknown(statement) if statement.ending == "{" else None

    def read(self, statement: Statement) -> Block | None:
        """Read a statement of at least one token; the block that it opens, if it does."""
        raise NotImplementedError

    def unknown(self, statement: Statement) -> Block | None:
        """A block that is not known, in which nothing will be read; none if its brace, in a line, is one too many."""
        self.source.unreadable(statement, "a block of an unknown kind")
        tokens = self.source.tokens
        ends_line = tokens[statement.end + 1].first
        return SkippedBlock(self.source, statement) if ends_line or not tokens.unclosed else None

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Look for claims in neighbouring comments."""


class SkippedBlock(Block):
    """A block in which nothing is read: a service, or something unknown. It counts the blocks that are open inside."""

    def take(self, statement: Statement) -> Block | None:
        """Skip a statement."""
        self.depth += statement.ending == "{"
        return None


class EnumBlock(Block):
    """The inside of an enum."""

    def __init__(self, source: Source, opening: Statement, name: str) -> None:
        super().__init__(source, opening)
        self.name = name
        self.values: list[ProtoEnumValue] = []
        self.reserved: list[Range] = []
        self.reserved_names: list[str] = []
        self.claims: list[ProtoEnumValue] = []

    def read(self, statement: Statement) -> Block | None:
        """Read a value, an option or what is reserved."""
        head = statement.tokens[0].text if len(statement.tokens) > 1 and statement.tokens[1].text != "=" else ""
        if head == "option":
            read_option(self.source, statement)
        elif head == "reserved":
            read_ranges(self.source, statement, self.reserved, self.reserved_names, signed=True)
        elif value := read_value(self.source, statement):
            self.values.append(value)
        return SkippedBlock(self.source, statement) if statement.ending == "{" else None

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Look for enum values that are commented out."""
        self.claims += claimed_values(self.source.text, comments)

    def build(self, scope: str) -> ProtoEnum:
        """The enum, in the package or message of this name."""
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
    """Read ``option``: its name and its value."""
    words = Words(statement.tokens)
    words.skip()
    name, value = words.option()
    if not (name and value and statement.ending):
        source.unreadable(statement, "an option that is not written as it should be")
    return name, value


def read_ranges(
    source: Source, statement: Statement, ranges: list[Range], names: list[str], signed: bool = False
) -> None:
    """Read ``reserved`` or ``extensions``."""
    words = Words(statement.tokens)
    words.skip()
    found_ranges, found_names = words.ranges(signed)
    ranges += found_ranges
    names += found_names
    words.skip_brackets()
    if not (words.done and words.closed and statement.ending and (found_ranges or found_names)):
        source.unreadable(statement, "numbers or names that are not written as they should be")


def with_end(ranges: list[Range], largest: int) -> tuple[tuple[int, int], ...]:
    """Ranges, with what ``max`` is."""
    return tuple((start, largest if end is MAX else end) for start, end in ranges)
