"""nanopb's options of a schema, from all the places where they can stand, each where it holds.

What is said of a file holds for its messages, and what is said of a message for its fields and oneofs; not for the
messages inside, nor does a oneof hand its options on. At each of these levels, a line of the .options file goes before
what comes from above, a later line before an earlier one, and options inside the .proto file before them all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from generator.diagnostics import Diagnostic, Span, shown
from generator.nanopb.bounds import Bounds, FieldBounds, MessageBounds
from generator.nanopb.faults import PATTERN_WITHOUT_MATCH, UNREADABLE_OPTIONS
from generator.nanopb.names import PatternNames, further_names
from generator.nanopb.options import Decoded, decode_options
from generator.nanopb.options_file import OptionsLine, options_file_of, read_options_file
from generator.nanopb.settings import Settings
from generator.protos import Declared, ProtoEnum, ProtoExtension, ProtoField, ProtoMessage, Schema


def read_bounds(
    schema: Schema,
    root: Path,
    shown_root: str,
    findings: list[Diagnostic],
    of_table: Mapping[str, list[OptionsLine]] = MappingProxyType({}),
) -> Bounds:
    """The options of nanopb's that hold for the messages and fields of a schema.

    ``root`` is the folder of its .proto files, and ``shown_root`` how findings call it; ``of_table`` are the lines that
    the table has for them, by file. A line of a .options file that
    cannot be read, or is for nothing, becomes a finding, as does an option in a .proto file that cannot be read.
    """
    messages: dict[str, MessageBounds] = {}
    fields: dict[tuple[str, str], FieldBounds] = {}
    for contents in _by_file(schema, shown_root):
        lines = read_options_file(root, options_file_of(contents.file), shown_root, findings)
        lines += of_table.get(contents.file, [])
        reader = _FileReader(schema, contents, lines, findings)
        reader.read(messages, fields)
        for line in reader.unused():
            message = f"nothing in {contents.file} has a name that matches {line.pattern}"
            help = "a name is that of a message, then the field's, package included: pkg.Message.field"
            findings.append(PATTERN_WITHOUT_MATCH.at(line.span, message, help))
    return Bounds(messages, fields)


@dataclass(frozen=True, slots=True)
class _Contents:
    """What one file declares."""

    file: str
    span: Span
    messages: list[ProtoMessage] = field(default_factory=list)
    enums: list[ProtoEnum] = field(default_factory=list)
    extensions: list[ProtoExtension] = field(default_factory=list)


def _by_file(schema: Schema, shown_root: str) -> Iterator[_Contents]:
    files = {file: _Contents(file, Span(shown(shown_root, file))) for file in schema.files}
    for message in schema.messages.values():
        files[message.file].messages.append(message)
    for enum in schema.enums.values():
        files[enum.file].enums.append(enum)
    for extension in schema.extensions:
        files[extension.file].extensions.append(extension)
    yield from files.values()


class _FileReader:
    """Reads the options of one file and of all that it declares."""

    def __init__(
        self, schema: Schema, contents: _Contents, lines: list[OptionsLine], findings: list[Diagnostic]
    ) -> None:
        self._contents = contents
        self._lines = lines
        self._findings = findings
        self._used: set[int] = set()
        decoded = self._decoded(schema.file_options.get(contents.file, b""), contents.span)
        self._of_file = self._settings(Settings(), contents.file, decoded, contents.span)
        self._package = schema.packages[contents.file]
        self._names = PatternNames(self._package, self._of_file.text("package"), self._of_file.text("mangle_names"))

    def unused(self) -> list[OptionsLine]:
        """The lines that were for nothing."""
        return [line for index, line in enumerate(self._lines) if index not in self._used]

    def read(self, messages: dict[str, MessageBounds], fields: dict[tuple[str, str], FieldBounds]) -> None:
        """Add what holds for the file's messages and their fields."""
        for message in self._contents.messages:
            self._message(message, messages, fields)
        for enum in self._contents.enums:
            self._declared(self._of_file, self._names.of(enum.full_name), enum)
        for extension in self._contents.extensions:
            scope = extension.scope or self._package
            name = f"{scope}.{extension.field.name}" if scope else extension.field.name
            self._declared(self._of_file, self._names.of(name), extension.field)

    def _message(
        self,
        message: ProtoMessage,
        messages: dict[str, MessageBounds],
        fields: dict[tuple[str, str], FieldBounds],
    ) -> None:
        name = self._names.of(message.full_name)
        inside = self._decoded(message.options, message.span)
        settings = self._settings(self._of_file, name, inside, message.span)
        # To nanopb, the options inside a message are those inside its oneofs as well, and go before lines for a oneof.
        oneofs = {one: self._settings(settings, f"{name}.{one}", inside, message.span) for one in message.oneofs}
        for further in further_names(message):
            self._settings(settings, f"{name}.{further}", inside, message.span)
        separate = frozenset(one for one, of_one in oneofs.items() if of_one.on("no_unions"))
        ignored = {one for one, of_one in oneofs.items() if of_one.text("type") == "FT_IGNORE"} - separate
        skipped = settings.on("skip_message") or (inside.deprecated and settings.on("discard_deprecated"))
        messages[message.full_name] = MessageBounds(skipped, separate)
        for part in message.fields:
            of_field, deprecated = self._declared(settings, f"{name}.{part.name}", part)
            left_out = part.oneof in ignored or (deprecated and of_field.on("discard_deprecated"))
            fields[message.full_name, part.name] = of_field.of_field(left_out)

    def _declared(self, inherited: Settings, name: str, declared: Declared) -> tuple[Settings, bool]:
        """What holds for a declaration, and whether that is deprecated."""
        span = declared.at("options") if isinstance(declared, ProtoField) else declared.span
        decoded = self._decoded(declared.options, span)
        return self._settings(inherited, name, decoded, span), decoded.deprecated

    def _decoded(self, options: bytes, span: Span) -> Decoded:
        decoded = decode_options(options) if options else _NOTHING
        self._findings.extend(UNREADABLE_OPTIONS.at(span, fault) for fault in decoded.faults)
        return decoded

    def _settings(self, inherited: Settings, name: str, decoded: Decoded, span: Span) -> Settings:
        settings = inherited
        for index, line in enumerate(self._lines):
            if line.matches(name):
                self._used.add(index)
                settings = settings.with_(line.values, line.span)
        return settings.with_(decoded.values, span)


_NOTHING = Decoded({}, False, ())
