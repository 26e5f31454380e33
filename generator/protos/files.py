"""The .proto files of a project, and an index of the messages that they declare, made without protoc.

Only the files that the table needs, and their imports, are compiled. So a file that does not compile does no harm if
nothing needs it.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, Span, shown
from roverlink.generator.protos.parser import File, parse
from roverlink.generator.protos.proto_rules import UNREADABLE_PROTO

_LARGEST = 4 * 1024 * 1024  # bytes; the largest .proto files that people write have a few hundred thousand


@dataclass(frozen=True, slots=True)
class DeclarationIndex:
    """The files that declare each message, by the message's full name. Paths are relative to the root of the protos."""

    files: dict[str, list[str]]
    excluded: dict[str, list[str]]
    """The files under `proto.exclude` that declare each message, by the message's full name."""


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

    Symbolic links are followed. Hidden files are ignored, because editors make them.

    Reports a folder that cannot be listed, a link that leads back to a folder above it, and a name that is not UTF-8.
    """

    def unreadable(error: OSError) -> None:
        folder = shown(shown_root, Path(error.filename).relative_to(root).as_posix())
        findings.append(UNREADABLE_PROTO.at(Span(folder), f"cannot be listed: {error.strerror}"))

    found: list[str] = []
    # os.walk does not remember where it has been: with followlinks, a link to a folder above it would be followed again
    # and again. A link to a folder elsewhere is fine; people share protos that way.
    above: dict[str, frozenset[str]] = {str(root): frozenset([os.path.realpath(root)])}
    for folder, folders, files in os.walk(root, followlinks=True, onerror=unreadable):
        here = Path(folder).relative_to(root)
        found += [(here / file).as_posix() for file in files if file.endswith(".proto") and not file.startswith(".")]
        for name in list(folders):
            path = os.path.join(folder, name)
            real = os.path.realpath(path)
            above[path] = above[folder] | {real}
            if real in above[folder]:
                folders.remove(name)
                span = Span(shown(shown_root, (here / name).as_posix()))
                message = "is a link to a folder that contains it; the link was not followed"
                findings.append(UNREADABLE_PROTO.at(span, message, "remove the link"))
    return [name for name in sorted(found) if _is_text(name, shown_root, findings)]


def _is_text(name: str, shown_root: str, findings: list[Diagnostic]) -> bool:
    """Return True if a file's name is UTF-8, which protoc and JSON need; report it otherwise."""
    # os.walk returns bytes that are not UTF-8 as lone surrogates (PEP 383). They cannot be written to JSON or to a
    # terminal.
    readable = os.fsencode(name).decode("utf-8", errors="backslashreplace")
    if readable != name:
        span = Span(shown(shown_root, readable))
        findings.append(UNREADABLE_PROTO.at(span, "has a name that is not UTF-8", "rename it"))
    return readable == name


def read_protos(root: Path, shown_root: str, findings: list[Diagnostic]) -> dict[str, File]:
    """Parse the .proto files below a folder, and return their content by path. Files that cannot be read are reported.

    ``shown_root`` is the folder's name in diagnostics.
    """
    texts = {name: read_proto(root, name, shown_root, findings) for name in proto_files(root, shown_root, findings)}
    return {name: declarations(text) for name, text in texts.items() if text is not None}


@lru_cache(maxsize=1024)
def declarations(text: str) -> File:
    """Parse the text of a .proto file. Results are cached, because one run reads some files several times."""
    return parse(text)


def read_proto(root: Path, name: str, shown_root: str, findings: list[Diagnostic]) -> str | None:
    """Return the text of a .proto file. If it cannot be read, report that and return None."""
    path, span = root / name, Span(shown(shown_root, name))
    data = b""
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode):  # reading a pipe or a device might never end
            fault = "is not a regular file"
        elif about.st_size > _LARGEST:
            fault = f"has {about.st_size} bytes; files of more than {_LARGEST} bytes are not read"
        else:
            data = path.read_bytes()
            fault = "is a binary file, not the text of a .proto file" if b"\0" in data else ""
    except OSError as error:
        fault = f"cannot be read: {error.strerror}"
    if fault:
        findings.append(UNREADABLE_PROTO.at(span, fault))
        return None
    return data.decode("utf-8", errors="replace")
