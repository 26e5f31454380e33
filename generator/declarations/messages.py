"""The blocks of messages, and those that stand in a message or in a file: oneofs and ``extend``."""

from __future__ import annotations

from generator.declarations.blocks import Block, EnumBlock, SkippedBlock, read_option, read_ranges, with_end
from generator.declarations.claims import claims_in
from generator.declarations.fields import is_group, read_field
from generator.declarations.model import (
    LARGEST_FIELD_NUMBER,
    LARGEST_MESSAGE_SET_NUMBER,
    Claim,
    Extend,
    Field,
    Message,
)
from generator.declarations.phrases import Range, Words
from generator.declarations.source import Source
from generator.declarations.statements import BLOCKS, VISIBILITIES, Statement
from generator.declarations.tokens import Comment


class Scope(Block):
    """A block that types are declared in: a message, or the file."""

    messages: list[MessageBlock]
    enums: list[EnumBlock]
    extends: list[ExtendBlock]

    def open(self, statement: Statement) -> Block | None:
        """The block of a type or of an ``extend``, if this statement opens one."""
        texts = [token.text for token in statement.tokens]
        texts = texts[1:] if texts[0] in VISIBILITIES else texts
        if texts[0] == "extend":
            extend = ExtendBlock(self.source, statement, self)
            self.extends.append(extend)
            return extend
        if not texts[1:] or not texts[1].isidentifier():
            return None
        if texts[2:] and texts[0] in BLOCKS:
            self.source.unreadable(statement, "too much before an opening brace")
        if texts[0] == "message":
            message = MessageBlock(self.source, statement, texts[1])
            self.messages.append(message)
            return message
        if texts[0] == "enum":
            enum = EnumBlock(self.source, statement, texts[1])
            self.enums.append(enum)
            return enum
        return None

    def read_field(self, statement: Statement, fields: list[Field], oneof: str = "") -> Block | None:
        """Read a field; the message that it opens, if it is a group."""
        if field := read_field(self.source, statement, oneof):
            fields.append(field)
            if is_group(statement):
                names = [token.text for token in statement.tokens if token.text.lower() == field.name]
                group = MessageBlock(self.source, statement, names[0])
                self.messages.append(group)
                return group
        return SkippedBlock(self.source, statement) if statement.ending == "{" else None


class MessageBlock(Scope):
    """The inside of a message."""

    def __init__(self, source: Source, opening: Statement, name: str) -> None:
        super().__init__(source, opening)
        self.name = name
        self.comment = source.comment(opening)
        self.fields: list[Field] = []
        self.oneofs: list[str] = []
        self.messages, self.enums, self.extends = [], [], []
        self.reserved: list[Range] = []
        self.reserved_names: list[str] = []
        self.extension_ranges: list[Range] = []
        self.options: dict[str, str] = {}
        self.claims: list[Claim] = []

    def read(self, statement: Statement) -> Block | None:
        """Read a field, an option, what is reserved, or the beginning of a block."""
        if statement.ending == "{":
            return self._open(statement)
        head = statement.tokens[0].text
        is_field = any(token.is_symbol("=") for token in statement.tokens[:3])  # `reserved x = 1`: a type of that name
        if is_field and (head in BLOCKS or head in ("reserved", "extensions")):
            self.source.unreadable(statement, "a keyword in the place of a type")
            self.read_field(statement, self.fields)
        elif head in BLOCKS:
            self.source.unreadable(statement, "a block without its braces")
        elif head == "option":
            read_option(self.source, statement, self.options)
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
        if (block := self.open(statement)) or is_group(statement):
            return block or self.read_field(statement, self.fields)
        return self.unknown(statement)

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Look for fields that are commented out."""
        self.claims += claims_in(self.source.text, comments, values=False, oneof="")

    def build(self, scope: str) -> Message:
        """The message, in the package or message of this name."""
        full_name = f"{scope}.{self.name}" if scope else self.name
        message_set = self.options.get("message_set_wire_format") == "true"
        largest = LARGEST_MESSAGE_SET_NUMBER if message_set else LARGEST_FIELD_NUMBER
        return Message(
            name=self.name,
            full_name=full_name,
            fields=tuple(self.fields),
            oneofs=tuple(self.oneofs),
            messages=tuple(message.build(full_name) for message in self.messages),
            enums=tuple(enum.build(full_name) for enum in self.enums),
            reserved=with_end(self.reserved, largest),
            reserved_names=tuple(self.reserved_names),
            extension_ranges=with_end(self.extension_ranges, largest),
            options=self.options,
            comment=self.comment,
            claims=tuple(self.claims),
            line=self.opening.line,
            column=self.opening.column,
            end_line=self.end_line,
        )

    def build_extends(self, scope: str) -> list[Extend]:
        """The ``extend`` blocks in this message and in those inside."""
        return build_extends(self, f"{scope}.{self.name}" if scope else self.name)


class OneofBlock(Block):
    """The inside of a oneof, whose fields are its message's."""

    def __init__(self, source: Source, opening: Statement, message: MessageBlock) -> None:
        super().__init__(source, opening)
        self._name, self._message = opening.tokens[1].text, message

    def read(self, statement: Statement) -> Block | None:
        """Read a field; or an option, which is nobody's concern."""
        if statement.tokens[0].text == "option" and statement.ending != "{":
            return None
        return self._message.read_field(statement, self._message.fields, self._name)

    def claim(self, comments: tuple[Comment, ...]) -> None:
        """Look for members that are commented out."""
        self._message.claims += claims_in(self.source.text, comments, values=False, oneof=self._name)


class ExtendBlock(Block):
    """The inside of an ``extend``, whose groups are messages of the scope around it."""

    def __init__(self, source: Source, opening: Statement, scope: Scope) -> None:
        super().__init__(source, opening)
        words = Words(opening.tokens)
        words.skip()
        self._extendee, self._scope = words.type_name(), scope
        self._fields: list[Field] = []

    def read(self, statement: Statement) -> Block | None:
        """Read a field."""
        return self._scope.read_field(statement, self._fields)

    def build(self, scope: str) -> Extend:
        """The fields, with where they stand."""
        return Extend(self._extendee, scope, tuple(self._fields), self.opening.line, self.opening.column)


def build_extends(scope: Scope, name: str) -> list[Extend]:
    """The ``extend`` blocks of a scope with this full name, and of the messages in it."""
    inside = [extend for message in scope.messages for extend in message.build_extends(name)]
    return [*(extend.build(name) for extend in scope.extends), *inside]
