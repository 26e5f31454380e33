"""The .proto files of a project, and an index of the messages that they declare, made without protoc.

The index tells which files the rows of mapping.yaml need. `roverlink generate` compiles only these files and their
imports, so a broken file that no row needs causes no error.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, Span, shown
from roverlink.generator.protos.parser import File, parse
from roverlink.generator.protos.proto_rules import UnreadableProto

_LARGEST_TREE = 32 << 20  # bytes of all .proto files of a tree; the parser needs about 70 times as much memory
_HELP = "correct the file, replace a link by a copy, or move it out of the folder"


@dataclass(frozen=True, slots=True)
class DeclarationIndex:
    """The .proto files that declare each message. Paths are relative to the proto root."""

    files: dict[str, list[str]]
    """The files that declare a message, by the message's full name; without excluded files."""
    excluded: dict[str, list[str]]
    """The same for the files that mapping.yaml lists under `proto.exclude`."""


def index_declarations(files: Mapping[str, File], exclude: Iterable[str]) -> DeclarationIndex:
    """Return the index of the messages in some files; ``exclude`` are the paths of files that are never compiled."""
    left_out = {str(PurePosixPath(path)) for path in exclude}
    index = DeclarationIndex({}, {})
    for path, file in files.items():
        target = index.excluded if path in left_out else index.files
        for name in dict.fromkeys(message.full_name for message in file.messages):
            target.setdefault(name, []).append(path)
    return index


def proto_files(root: Path, shown_root: str, findings: list[Diagnostic]) -> list[str]:
    """Return the paths of the .proto files below a folder, relative to the folder.

    Symbolic links inside the repository are followed. Hidden files are ignored, because editors make them.

    Adds a diagnostic for a folder that is not read, such as a link to a folder above it, and for a name that is not
    UTF-8. ``shown_root`` is the name of the folder ``root`` in diagnostics.
    """

    def unread(path: str, fault: str) -> None:
        findings.append(UnreadableProto.at(Span(shown(shown_root, source_files.printable(path))), fault, _HELP))

    found = [path for path in source_files.walk(root, unread) if path.endswith(".proto")]
    visible = [path for path in found if not path.rpartition("/")[2].startswith(".")]
    return [name for name in visible if _is_text(name, shown_root, findings)]


def _is_text(name: str, shown_root: str, findings: list[Diagnostic]) -> bool:
    """Return True if a file's name is UTF-8, which protoc and JSON need; report it otherwise."""
    readable = source_files.printable(name)
    if readable != name:
        span = Span(shown(shown_root, readable))
        findings.append(UnreadableProto.at(span, "the name of the file is not UTF-8", "rename the file"))
    return readable == name


def read_protos(root: Path, shown_root: str, findings: list[Diagnostic]) -> dict[str, File]:
    """Parse the .proto files below a folder, and return their declarations by path.

    Adds a diagnostic for each file that cannot be read. ``shown_root`` is the folder's name in diagnostics.
    """
    found: dict[str, File] = {}
    size = 0
    for name in proto_files(root, shown_root, findings):
        if size > _LARGEST_TREE:
            message = f"the .proto files have more than {_LARGEST_TREE} bytes; this and all later ones were not read"
            findings.append(UnreadableProto.at(Span(shown(shown_root, name)), message, "check a smaller folder"))
            break
        text = read_proto(root, name, shown_root, findings)
        if text is not None:
            found[name] = declarations(text)
            size += len(text)
    return found


@lru_cache(maxsize=1024)
def declarations(text: str) -> File:
    """Parse the text of a .proto file. Results are cached, because one run reads some files several times."""
    return parse(text)


def read_proto(root: Path, name: str, shown_root: str, findings: list[Diagnostic]) -> str | None:
    """Return the text of a .proto file. If it cannot be read, report that and return None."""
    span = Span(shown(shown_root, name))
    data = b""
    try:
        data = source_files.read(root, name)
        fault = "the file is binary, and not the text of a .proto file" if b"\0" in data else ""
    except OSError as error:
        fault = f"the file cannot be read: {error.strerror}"
    if fault:
        findings.append(UnreadableProto.at(span, fault, _HELP))
        return None
    return data.decode("utf-8", errors="replace")
