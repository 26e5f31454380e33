"""nanopb's options of a schema: collects them from all places, and applies nanopb's order of precedence.

A message inherits the options of its file; fields and oneofs inherit those of their message. Nested messages do not
inherit from the outer message, nor members from their oneof. At each of these levels the last one wins:

- inherited options,
- lines of the .options file, in their order,
- options inside the .proto file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from roverlink.generator.diagnostics import Diagnostic, Severity, Span, shown
from roverlink.generator.nanopb.bounds import Bounds, FieldBounds, MessageBounds
from roverlink.generator.nanopb.option_rules import NanopbNotInstalled, UnreadableNanopbOptions
from roverlink.generator.nanopb.options import Decoded, decode_options
from roverlink.generator.nanopb.options_file import OptionsLine, options_file_of, read_options_file
from roverlink.generator.nanopb.vocabulary import has_options, vocabulary
from roverlink.generator.protos.schema import ProtoEnum, ProtoExtension, ProtoField, ProtoMessage, Schema

_Options = Mapping[str, tuple[Any, Span]]  # nanopb.proto declares the type of each option
"""The options that apply to a declaration, by name: each value, with the place that set it."""


def read_bounds(
    schema: Schema,
    root: Path,
    shown_root: str,
    findings: list[Diagnostic],
    of_table: Mapping[str, list[OptionsLine]] = MappingProxyType({}),
    *,
    needed: bool = False,
) -> Bounds | None:
    """Return nanopb's options for the messages and fields of a schema.

    ``root`` is the folder of the .proto files, and ``shown_root`` its name in diagnostics. ``of_table`` has the size
    limits of mapping.yaml as lines of .options files, by .proto file. ``needed`` is true if a peer limits the sizes of
    messages, so that nothing can be checked without the options.

    Adds a diagnostic for options that cannot be read. If there are options but nanopb is not installed, reports only
    this, and returns None.
    """
    place = _place_of_options(schema, root, shown_root)
    if place is not None:
        try:
            vocabulary()
        except ModuleNotFoundError:
            problem = "nanopb is not installed, so its options were not read, and no sizes were checked"
            finding = NanopbNotInstalled.at(place, problem, "install nanopb: pip install 'nanopb>=0.4.9,<0.5'")
            findings.append(finding if needed else replace(finding, severity=Severity.HINT))
            return None
    messages: dict[str, MessageBounds] = {}
    fields: dict[tuple[str, str], FieldBounds] = {}
    readers: dict[str, _FileReader] = {}
    for file in schema.files:
        lines = read_options_file(root, options_file_of(file), shown_root, findings) + of_table.get(file, [])
        readers[file] = _FileReader(schema, file, shown(shown_root, file), lines, findings, place is not None)
    for message in schema.messages.values():
        readers[message.file].read_message(message, messages, fields)
    for enum in schema.enums.values():
        readers[enum.file].read_enum(enum)
    for extension in schema.extensions:
        readers[extension.file].read_extension(extension)
    unused = tuple((file, line.pattern, line.span) for file, reader in readers.items() for line in reader.unused())
    return Bounds(messages, fields, unused)


def _place_of_options(schema: Schema, root: Path, shown_root: str) -> Span | None:
    """Return the first place in a .options or .proto file that sets an option of nanopb; None if there is none."""
    for file in schema.files:
        if (root / options_file_of(file)).exists():
            return Span(shown(shown_root, options_file_of(file)))
        if has_options(schema.file_options.get(file, b"")):
            return Span(shown(shown_root, file))
    parts = [part for message in schema.messages.values() for part in (message, *message.fields)]
    return next((part.span for part in (*parts, *schema.enums.values()) if has_options(part.options)), None)


class _FileReader:
    """Reader of nanopb's options for one .proto file and all its declarations."""

    def __init__(
        self,
        schema: Schema,
        file: str,
        shown_file: str,
        lines: Sequence[OptionsLine],
        findings: list[Diagnostic],
        decodes: bool,
    ) -> None:
        """Read the options that apply to the whole file.

        ``lines`` are the lines of its .options file. If ``decodes`` is false, options inside .proto files are ignored.
        """
        self._lines, self._findings, self._decodes = lines, findings, decodes
        self._used: set[int] = set()
        package, span = schema.packages[file], Span(shown_file)
        decoded = self._decoded("File", schema.file_options.get(file, b""), span)
        self._of_file = self._in_force({}, file, decoded, span)
        self._package = f"{package}." if package else ""
        self._prefix, self._flat = _mangling(package, self._of_file)

    def unused(self) -> list[OptionsLine]:
        """Return the lines of the .options file whose pattern has matched no name yet."""
        return [line for index, line in enumerate(self._lines) if index not in self._used]

    def read_enum(self, enum: ProtoEnum) -> None:
        """Mark the lines that match an enum as used. Their options are not needed, because they change no size."""
        decoded = self._decoded("Enum", enum.options, enum.span)
        self._in_force(self._of_file, self._name(enum.full_name), decoded, enum.span)

    def read_extension(self, extension: ProtoExtension) -> None:
        """Mark the lines that match an extension as used.

        Their options are not needed: sizes do not count extensions.
        """
        scope = f"{extension.scope}." if extension.scope else self._package
        self._field(self._of_file, self._name(f"{scope}{extension.field.name}"), extension.field)

    def _name(self, full_name: str) -> str:
        """Return the name of a declaration that nanopb compares with the patterns of .options files.

        The name depends on nanopb's option ``mangle_names``.
        """
        inner = full_name.removeprefix(self._package)
        return inner.rpartition(".")[2] if self._flat else self._prefix + inner

    def read_message(
        self,
        message: ProtoMessage,
        messages: dict[str, MessageBounds],
        fields: dict[tuple[str, str], FieldBounds],
    ) -> None:
        """Add the options that apply to a message and to its fields, to ``messages`` and ``fields``."""
        name = self._name(message.full_name)
        inside = self._decoded("Message", message.options, message.span)
        options = self._in_force(self._of_file, name, inside, message.span)
        # nanopb applies the options inside a message to its oneofs too. They override a line for a oneof.
        oneofs = {oneof: self._in_force(options, f"{name}.{oneof}", inside, message.span) for oneof in message.oneofs}
        for part in _further_parts(message):
            self._in_force(options, f"{name}.{part}", inside, message.span)
        separate = frozenset(oneof for oneof, of_one in oneofs.items() if _value(of_one, "no_unions"))
        ignored = {oneof for oneof, of_one in oneofs.items() if _value(of_one, "type") == "FT_IGNORE"} - separate
        skipped = _value(options, "skip_message") or (inside.deprecated and _value(options, "discard_deprecated"))
        messages[message.full_name] = MessageBounds(bool(skipped), separate)
        for field in message.fields:
            of_field, deprecated = self._field(options, f"{name}.{field.name}", field)
            left_out = field.oneof in ignored or (deprecated and _value(of_field, "discard_deprecated"))
            fields[message.full_name, field.name] = _field_bounds(of_field, bool(left_out))

    def _field(self, inherited: _Options, name: str, field: ProtoField) -> tuple[_Options, bool]:
        """Return the options of nanopb that apply to a field, and True if the field is deprecated."""
        span = field.at("options")
        decoded = self._decoded("Field", field.options, span)
        return self._in_force(inherited, name, decoded, span), decoded.deprecated

    def _decoded(self, host: str, options: bytes, span: Span) -> Decoded:
        decoded = decode_options(host, options) if options and self._decodes else Decoded({})
        self._findings.extend(UnreadableNanopbOptions.at(span, fault) for fault in decoded.faults)
        return decoded

    def _in_force(self, inherited: _Options, name: str, decoded: Decoded, span: Span) -> _Options:
        """Return the options that apply to a declaration.

        The ``inherited`` options are overridden by the lines of the .options file that match ``name``, and these by
        ``decoded``, the options inside the .proto file. ``span`` is the place of the declaration.
        """
        options = dict(inherited)
        for index, line in enumerate(self._lines):
            if line.matches(name):
                self._used.add(index)
                options |= {option: (value, line.span) for option, value in line.values.items()}
        return options | {option: (value, span) for option, value in decoded.values.items()}


def _mangling(package: str, of_file: _Options) -> tuple[str, bool]:
    """Return the prefix that replaces the package in names, and True if patterns match only the last part of a name.

    Both follow from nanopb's option ``mangle_names``, which shortens the names in C code.
    """
    mangling = _value(of_file, "mangle_names")
    used = "" if mangling == "M_STRIP_PACKAGE" else _value(of_file, "package") or package
    if mangling == "M_PACKAGE_INITIALS":
        used = "".join(part[0] for part in used.split(".") if part)
    return f"{used}." if used else "", mangling == "M_FLATTEN"


def _further_parts(message: ProtoMessage) -> Iterator[str]:
    """Yield the names in a message that a pattern can match besides its fields and declared oneofs."""
    if message.extendable:
        yield "extensions"  # the C member that holds the extensions of other files
    for field in message.fields:
        if field.declared_optional:
            yield f"_{field.name}"  # protoc's synthetic oneof for `optional` in proto3


def _value(options: _Options, name: str) -> Any:
    """Return the value of the option ``name``, without its place; None if the option is not set."""
    return options[name][0] if name in options else None


def _field_bounds(options: _Options, left_out: bool) -> FieldBounds:
    """Return the options of a field as a `FieldBounds`.

    ``left_out`` is true if nanopb leaves the field out for another reason than its option ``type``.
    """
    values = {name: value for name, (value, _) in options.items()}
    bits = values.get("int_size", "").removeprefix("IS_")
    return FieldBounds(
        max_size=values.get("max_size"),
        max_length=values.get("max_length"),
        max_count=values.get("max_count"),
        fixed_length=values.get("fixed_length", False),
        fixed_count=values.get("fixed_count", False),
        type=values.get("type", "FT_DEFAULT"),
        int_size=int(bits) if bits.isdigit() else 0,
        type_override=values.get("type_override", "").removeprefix("TYPE_").lower(),
        label_override=values.get("label_override", "").removeprefix("LABEL_").lower(),
        ignored=left_out or values.get("type") == "FT_IGNORE",
        places={name: span for name, (_, span) in options.items()},
    )
