"""The .proto files: which one declares what, and what protoc makes of those that the table needs.

Only the import closure of what the table names is compiled, so a file that does not compile, and that nobody needs,
does no harm.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool

from generator.findings import Finding, FindingsError, Rule, Severity, Span

DOES_NOT_COMPILE = Rule("PRO101", "proto-does-not-compile")
UNREADABLE_PROTO = Rule("PRO102", "unreadable-proto", Severity.FATAL)

_SCALARS = {number: name.removeprefix("TYPE_").lower() for name, number in FieldDescriptorProto.Type.items()}


@dataclass(frozen=True, slots=True)
class ProtoField:
    """A field of a message, or of a oneof in it."""

    number: int
    name: str
    type: str
    """The scalar's name; or ``message``, ``enum``, ``group``."""
    type_name: str
    """Full name of the message or enum; empty for a scalar."""
    repeated: bool
    optional: bool
    """Whether it tells *absent* from *zero*; of a message field, only where it was declared ``optional``."""
    oneof: str
    """The oneof it stands in; empty for none."""
    comment: str
    span: Span

    @property
    def wire_type(self) -> str:
        """The type as a .proto file spells it."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True)
class ProtoMessage:
    """A message type."""

    full_name: str
    file: str
    fields: tuple[ProtoField, ...]
    comment: str
    span: Span
    map_entry: bool
    extendable: bool
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers that are reserved, both ends included."""
    reserved_names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ProtoEnumValue:
    """A declared value of an enum."""

    name: str
    number: int
    comment: str


@dataclass(frozen=True, slots=True)
class ProtoEnum:
    """An enum type."""

    full_name: str
    file: str
    values: tuple[ProtoEnumValue, ...]
    comment: str
    span: Span


@dataclass(frozen=True, slots=True)
class Schema:
    """What protoc made of the files that the table needs."""

    files: tuple[str, ...]
    """The closure, in the order in which protoc wants it."""
    messages: Mapping[str, ProtoMessage]
    enums: Mapping[str, ProtoEnum]
    modules: Mapping[str, str]
    """Text of each module that protoc generated (pb2 and its stub), by path."""


# --- where is what declared -------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?|[A-Za-z_][\w.]*|[{};=]""", re.DOTALL
)
_DEEPEST = 32  # protoc takes no more messages in messages


class DeclarationIndex:
    """Which file declares which message, without compiling any."""

    def __init__(self, root: Path, exclude: Iterable[str], shown_root: str) -> None:
        """``shown_root`` is how findings call the root. Raises `FindingsError` for a file that cannot be read."""
        excluded = {str(PurePosixPath(path)) for path in exclude}
        self.excluded: dict[str, list[str]] = {}
        """Like `files`, of the excluded files."""
        self.files: dict[str, list[str]] = {}
        """The files, relative to the root, that declare a name."""
        for path in sorted(root.rglob("[!.]*.proto")):  # a hidden file is an editor's
            name = path.relative_to(root).as_posix()
            target = self.excluded if name in excluded else self.files
            for declared in sorted(set(declared_names(_read(path, f"{shown_root}/{name}")))):
                target.setdefault(declared, []).append(name)


def _read(path: Path, shown: str) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise FindingsError([UNREADABLE_PROTO.at(Span(shown), f"cannot be read: {error.strerror}")]) from error


def declared_names(text: str) -> Iterator[str]:
    """The full names of the messages that a .proto file declares, nested ones included."""
    words = [word for word in _TOKEN.findall(text) if not word.startswith(("//", "/*"))]
    package = ""
    scopes: list[str] = []
    for index, word in enumerate(words):
        if word == "package" and not scopes and words[index + 2 : index + 3] == [";"]:
            package = words[index + 1]
        elif word == "{":
            declares = index >= 2 and words[index - 2] == "message"
            scopes.append(words[index - 1] if declares else "")
            if declares and len(scopes) <= _DEEPEST and all(scopes):
                yield ".".join([*filter(None, [package]), *scopes])
        elif word == "}" and scopes:
            scopes.pop()


# --- compiling --------------------------------------------------------------------------------------------------


def compile_protos(root: Path, files: Sequence[str], overlay: Mapping[str, str], shown_root: str) -> Schema:
    """Run protoc over files and what they import.

    ``overlay`` holds files that are not on disk yet, or not as they will be; ``shown_root`` is how findings call the
    root. Raises `FindingsError` with protoc's own messages.
    """
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        over, out, result = Path(folder, "overlay"), Path(folder, "out"), Path(folder, "set")
        out.mkdir()
        for path, text in overlay.items():
            target = over / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        folders = [over, root] if overlay else [root]
        _protoc(folders, files, out, result, shown_root)
        compiled = FileDescriptorSet.FromString(result.read_bytes())
        own = [file.name for file in compiled.file if not file.name.startswith("google/protobuf/")]
        extra = [name for name in own if name not in files]
        if extra:  # protoc generates modules for the files it is given, not for what they import
            _protoc(folders, own, out, result, shown_root)
        modules = {
            path.relative_to(out).as_posix(): path.read_text(encoding="utf-8") for path in sorted(out.rglob("*.py*"))
        }
    return _schema(compiled, modules, shown_root)


def _protoc(folders: Sequence[Path], files: Sequence[str], out: Path, result: Path, shown_root: str) -> None:
    command = [sys.executable, "-m", "grpc_tools.protoc"]
    command += [f"-I{folder}" for folder in folders]
    command += [f"--python_out={out}", f"--pyi_out={out}", f"--descriptor_set_out={result}"]
    command += ["--include_imports", "--include_source_info", *files]
    # In a folder of its own, lest a module of the user's be taken for one of Python's.
    done = subprocess.run(command, cwd=out, capture_output=True, text=True, check=False)  # noqa: S603  # our own Python
    if done.returncode:
        raise FindingsError(_protoc_findings(done.stderr, folders, shown_root))


_PROTOC_MESSAGE = re.compile(r"(?P<file>[^:\s][^:]*\.proto):(?:(?P<line>\d+):(?P<column>\d+):)? *(?P<text>.*)")


def _protoc_findings(output: str, folders: Sequence[Path], shown_root: str) -> list[Finding]:
    """What protoc says; of the overlay, which is ours, only where there is nothing else to say."""
    *overlays, root = (f"{folder}/" for folder in folders)  # it names a file by where it found it
    matches = [match for line in output.splitlines() if (match := _PROTOC_MESSAGE.fullmatch(line))]
    errors = [match for match in matches if not match["text"].startswith("warning:")]
    theirs = [match for match in errors if not match["file"].startswith(tuple(overlays))]
    places: dict[Span, list[str]] = {}
    for match in theirs or errors:
        file = match["file"].rpartition(root)[2]
        span = Span(f"{shown_root}/{file}", int(match["line"] or 0), int(match["column"] or 0))
        places.setdefault(span, []).append(match["text"])
    if not places:
        return [DOES_NOT_COMPILE.at(Span(shown_root), f"protoc failed: {output.strip() or 'without a message'}")]
    return [DOES_NOT_COMPILE.at(span, first, " ".join(rest)) for span, (first, *rest) in places.items()]


# --- descriptors to our own words -------------------------------------------------------------------------------

_Comments = Mapping[tuple[int, ...], tuple[str, int, int]]

# Field numbers in descriptor.proto, of which the paths in source_code_info are made.
_FILE_MESSAGE, _FILE_ENUM = 4, 5
_MESSAGE_FIELD, _MESSAGE_NESTED, _MESSAGE_ENUM = 2, 3, 4
_ENUM_VALUE = 2


def _schema(compiled: FileDescriptorSet, modules: Mapping[str, str], shown_root: str) -> Schema:
    messages: dict[str, ProtoMessage] = {}
    enums: dict[str, ProtoEnum] = {}
    pool = DescriptorPool()
    for file in compiled.file:
        pool.Add(file)
        reader = _FileReader(file, pool, shown_root)
        prefix = f"{file.package}." if file.package else ""
        for index, message in enumerate(file.message_type):
            reader.message(message, prefix, (_FILE_MESSAGE, index), messages, enums)
        for index, enum in enumerate(file.enum_type):
            reader.enum(enum, prefix, (_FILE_ENUM, index), enums)
    return Schema(tuple(file.name for file in compiled.file), messages, enums, modules)


class _FileReader:
    """Reads one file's descriptors, with the comments and places that protoc kept for them."""

    def __init__(self, file: FileDescriptorProto, pool: DescriptorPool, shown_root: str) -> None:
        self._file, self._pool = file, pool
        self._shown = f"{shown_root}/{file.name}"
        self._places: _Comments = {
            tuple(location.path): (
                _clean(location.leading_comments) or _clean(location.trailing_comments),
                location.span[0] + 1,
                location.span[1] + 1,
            )
            for location in file.source_code_info.location
        }

    def _at(self, path: tuple[int, ...]) -> tuple[str, Span]:
        comment, line, column = self._places.get(path, ("", 0, 0))
        return comment, Span(self._shown, line, column)

    def message(
        self,
        message: DescriptorProto,
        prefix: str,
        path: tuple[int, ...],
        messages: dict[str, ProtoMessage],
        enums: dict[str, ProtoEnum],
    ) -> None:
        full_name = prefix + message.name
        comment, span = self._at(path)
        messages[full_name] = ProtoMessage(
            full_name,
            self._file.name,
            tuple(
                self._field(full_name, message, field, (*path, _MESSAGE_FIELD, index))
                for index, field in enumerate(message.field)
            ),
            comment,
            span,
            message.options.map_entry,
            bool(message.extension_range),
            tuple((reserved.start, reserved.end - 1) for reserved in message.reserved_range),
            tuple(message.reserved_name),
        )
        for index, nested in enumerate(message.nested_type):
            self.message(nested, f"{full_name}.", (*path, _MESSAGE_NESTED, index), messages, enums)
        for index, enum in enumerate(message.enum_type):
            self.enum(enum, f"{full_name}.", (*path, _MESSAGE_ENUM, index), enums)

    def _field(
        self, full_name: str, message: DescriptorProto, field: FieldDescriptorProto, path: tuple[int, ...]
    ) -> ProtoField:
        comment, span = self._at(path)
        named = field.type_name.removeprefix(".")
        kind = _SCALARS[field.type]
        named_message = kind in ("message", "group")
        required = field.label == FieldDescriptorProto.LABEL_REQUIRED
        presence = self._pool.FindFieldByName(f"{full_name}.{field.name}").has_presence and not required
        in_oneof = field.HasField("oneof_index") and not field.proto3_optional
        return ProtoField(
            number=field.number,
            name=field.name,
            type=kind,
            type_name=named,
            repeated=field.label == FieldDescriptorProto.LABEL_REPEATED,
            optional=field.proto3_optional or (presence and not named_message and not in_oneof),
            oneof=message.oneof_decl[field.oneof_index].name if in_oneof else "",
            comment=comment,
            span=span,
        )

    def enum(self, enum: EnumDescriptorProto, prefix: str, path: tuple[int, ...], enums: dict[str, ProtoEnum]) -> None:
        comment, span = self._at(path)
        values = tuple(
            ProtoEnumValue(value.name, value.number, self._at((*path, _ENUM_VALUE, index))[0])
            for index, value in enumerate(enum.value)
        )
        enums[prefix + enum.name] = ProtoEnum(prefix + enum.name, self._file.name, values, comment, span)


def _clean(comment: str) -> str:
    """A comment's text without the space after its slashes and without empty lines at its ends."""
    lines = [line.removeprefix(" ").rstrip() for line in comment.splitlines()]
    return "\n".join(lines).strip("\n")
