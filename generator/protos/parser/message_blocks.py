"""Blocks of messages, oneofs and ``extend``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from roverlink.generator.ir.protobuf_facts import LARGEST_FIELD_NUMBER
from roverlink.generator.protos.parser.blocks import Block, EnumBlock, SkippedBlock, read_option, read_ranges, with_end
from roverlink.generator.protos.parser.commented_out import claimed_fields
from roverlink.generator.protos.parser.field_statements import group_name, read_field
from roverlink.generator.protos.parser.parsed_file import LARGEST_MESSAGE_SET_NUMBER
from roverlink.generator.protos.parser.phrases import Range, Words
from roverlink.generator.protos.parser.source_text import Source
from roverlink.generator.protos.parser.statements import BLOCKS, VISIBILITIES, Statement
from roverlink.generator.protos.parser.tokens import Comment
from roverlink.generator.protos.schema import ProtoEnum, ProtoExtension, ProtoField, ProtoMessage


@dataclass(frozen=True, slots=True)
class Declarations:
    """The declarations of a file, while they are being collected from its blocks."""

    messages: list[ProtoMessage] = field(default_factory=list)
    enums: list[ProtoEnum] = field(default_factory=list)
    extensions: list[ProtoExtension] = field(default_factory=list)


class Scope(Block):
    """A block that may declare types: a message, or the file."""

    messages: list[MessageBlock]
    enums: list[EnumBlock]
    extends: list[ExtendBlock]

    def open(self, statement: Statement) -> Block | None:
        """Return the block of the message, enum or ``extend`` that a statement opens; None for other statements."""
        texts = [token.text for token in statement.tokens]
        texts = texts[1:] if texts[0] in VISIBILITIES else texts
        if texts[0] == "extend":
            extend = ExtendBlock(self.source, statement, self)
            self.extends.append(extend)
            return extend
        if not texts[1:] or not texts[1].isidentifier():
            return None
        if texts[2:] and texts[0] in BLOCKS:
            self.source.unreadable(statement, "surplus text before an opening brace")
        if texts[0] == "message":
            message = MessageBlock(self.source, statement, texts[1])
            self.messages.append(message)
            return message
        if texts[0] == "enum":
            enum = EnumBlock(self.source, statement, texts[1])
            self.enums.append(enum)
            return enum
        return None

    def read_field(self, statement: Statement, fields: list[ProtoField], oneof: str = "") -> Block | None:
        """Read a field and add it to ``fields``. If the field is a group, return the block of its message."""
        if field := read_field(self.source, statement, oneof):
            fields.append(field)
        if name := group_name(statement):
            group = MessageBlock(self.source, statement, name)
            self.messages.append(group)
            return group
        return SkippedBlock(self.source, statement) if statement.ending == "{" else None

    def collect(self, scope: str, found: Declarations, message: str = "") -> None:
        """Add all messages, enums and extensions in the block, at any depth, to ``found``.

        ``scope`` is the package or message whose name precedes the names of the declarations. ``message`` is the full
        name of this message; empty for the file.
        """
        found.enums.extend(enum.build(scope) for enum in self.enums)
        for extend in self.extends:
            found.extensions.extend(extend.build(message))
        for block in self.messages:
            built = block.build(scope)
            found.messages.append(built)
            block.collect(built.full_name, found, built.full_name)


class MessageBlock(Scope):
    """The content of a message."""

    def __init__(self, source: Source, opening: Statement, name: str) -> None:
        super().__init__(source, opening)
        self.name = name
        self.fields: list[ProtoField] = []
        self.oneofs: list[str] = []
        self.messages, self.enums, self.extends = [], [], []
        self.reserved: list[Range] = []
        self.reserved_names: list[str] = []
        self.extension_ranges: list[Range] = []
        self.largest = LARGEST_FIELD_NUMBER
        self.claims: list[ProtoField] = []

    def read(self, statement: Statement) -> Block | None:
        """Read a field, an option, a ``reserved`` or ``extensions`` statement, or the beginning of an inner block."""
        if statement.ending == "{":
            return self._open(statement)
        head = statement.tokens[0].text
        is_field = any(
            token.is_symbol("=") for token in statement.tokens[:3]
        )  # `reserved x = 1` is a field whose type is called `reserved`
        if is_field and (head in BLOCKS or head in ("reserved", "extensions")):
            self.source.unreadable(statement, "a keyword instead of a type")
            self.read_field(statement, self.fields)
        elif head in BLOCKS:
            self.source.unreadable(statement, "a block without braces")
        elif head == "option":
            # In a message set, the number of an extension is not limited by the tag: it is a field of its own
            # (MessageSet's type_id). So `extensions 4 to max` means more numbers there.
            if read_option(self.source, statement) == ("message_set_wire_format", "true"):
                self.largest = LARGEST_MESSAGE_SET_NUMBER
        elif head == "reserved":
            read_ranges(self.source, statement, self.reserved, self.reserved_names)
        elif head == "extensions":
            read_ranges(self.source, statement, self.extension_ranges, [])
        else:
            self.read_field(statement, self.fields)
        return None

    def _open(self, statement: Statement) -> Block | None:
        texts = [token.text for token in statement.tokens]
        if texts[0] == "oneof" and texts[1:] and texts[1].isidentifier():
            self.oneofs.append(texts[1])
            return OneofBlock(self.source, statement, self)
        if (block := self.open(statement)) or group_name(statement):
            return block or self.read_field(statement, self.fields)
        return self.unknown(statement)

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Find commented-out fields in comments of the message."""
        self.claims += claimed_fields(self.source.text, comments, oneof="")

    def build(self, scope: str) -> ProtoMessage:
        """Return the message that was read; ``scope`` is the package or message that contains the message."""
        return ProtoMessage(
            span=self.span,
            full_name=f"{scope}.{self.name}" if scope else self.name,
            fields=tuple(self.fields),
            oneofs=tuple(self.oneofs),
            reserved=with_end(self.reserved, self.largest),
            reserved_names=tuple(self.reserved_names),
            extension_ranges=with_end(self.extension_ranges, self.largest),
            claims=tuple(self.claims),
        )


class OneofBlock(Block):
    """The content of a oneof. Its fields are added to the message that contains the oneof."""

    def __init__(self, source: Source, opening: Statement, message: MessageBlock) -> None:
        super().__init__(source, opening)
        self._name, self._message = opening.tokens[1].text, message

    def read(self, statement: Statement) -> Block | None:
        """Read a field of the oneof. Options of the oneof are ignored, because they do not change the encoding."""
        if statement.tokens[0].text == "option" and statement.ending != "{":
            return None
        return self._message.read_field(statement, self._message.fields, self._name)

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Find commented-out members in comments of the oneof."""
        self._message.claims += claimed_fields(self.source.text, comments, self._name)


class ExtendBlock(Block):
    """The content of an ``extend``. A group in it declares a message of the scope that contains the ``extend``."""

    def __init__(self, source: Source, opening: Statement, scope: Scope) -> None:
        super().__init__(source, opening)
        words = Words(opening.tokens)
        words.skip()
        self._extendee, self._scope = words.type_name(), scope
        self._fields: list[ProtoField] = []

    def read(self, statement: Statement) -> Block | None:
        """Read an extension."""
        return self._scope.read_field(statement, self._fields)

    def build(self, scope: str) -> Iterator[ProtoExtension]:
        """Yield the extensions that were read; ``scope`` is the message that contains the ``extend``, or empty."""
        yield from (ProtoExtension(self._extendee, scope, field) for field in self._fields)
