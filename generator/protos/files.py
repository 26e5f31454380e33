"""Which .proto file declares which message and imports which files, without compiling any.

Only the import closure of what the table names is compiled, so a file that does not compile, and that nobody needs,
does no harm.
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

_LARGEST = 4 * 1024 * 1024  # bytes; the largest that people write have a few hundred thousand


@dataclass(frozen=True, slots=True)
class DeclarationIndex:
    """Which files, relative to the root, declare a message of a name."""

    files: dict[str, list[str]]
    excluded: dict[str, list[str]]
    """Of the files that never take part in a build."""


def index_declarations(files: Mapping[str, File], exclude: Iterable[str]) -> DeclarationIndex:
    """Return the index of what files declare; ``exclude`` are those that never take part in a build."""
    left_out = {str(PurePosixPath(path)) for path in exclude}
    index = DeclarationIndex({}, {})
    for path, file in files.items():
        target = index.excluded if path in left_out else index.files
        for name in dict.fromkeys(message.full_name for message in file.messages):
            target.setdefault(name, []).append(path)
    return index


def proto_files(root: Path, shown_root: str, findings: list[Diagnostic]) -> list[str]:
    """The .proto files below a folder, relative to it, links followed; hidden files are an editor's.

    A folder that cannot be listed, a link that leads back to where it is, and a name that is no text, is a finding.
    """

    def unreadable(error: OSError) -> None:
        folder = shown(shown_root, Path(error.filename).relative_to(root).as_posix())
        findings.append(UNREADABLE_PROTO.at(Span(folder), f"cannot be listed: {error.strerror}"))

    found: list[str] = []
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
                message = "is a link to a folder that it stands in; what is behind it was not looked at"
                findings.append(UNREADABLE_PROTO.at(span, message, "remove the link"))
    return [name for name in sorted(found) if _is_text(name, shown_root, findings)]


def _is_text(name: str, shown_root: str, findings: list[Diagnostic]) -> bool:
    """Whether a file's name can be said: protoc, JSON and terminals take UTF-8 alone."""
    readable = os.fsencode(name).decode("utf-8", errors="backslashreplace")
    if readable != name:
        span = Span(shown(shown_root, readable))
        findings.append(UNREADABLE_PROTO.at(span, "has a name that is not UTF-8", "rename it"))
    return readable == name


def read_protos(root: Path, shown_root: str, findings: list[Diagnostic]) -> dict[str, File]:
    """Return what the .proto files below a folder declare, as far as it can be read; any that has no text is a finding.

    ``shown_root`` is how findings call the folder.
    """
    texts = {name: read_proto(root, name, shown_root, findings) for name in proto_files(root, shown_root, findings)}
    return {name: declarations(text) for name, text in texts.items() if text is not None}


@lru_cache(maxsize=1024)
def declarations(text: str) -> File:
    """Parse the text of a file; what a run reads several times, it parses once."""
    return parse(text)


def read_proto(root: Path, name: str, shown_root: str, findings: list[Diagnostic]) -> str | None:
    """The text of a .proto file; None, with a finding, where it has none that anybody wrote."""
    path, span = root / name, Span(shown(shown_root, name))
    data = b""
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode):  # to read a pipe or a device might take for ever
            fault = "is no file"
        elif about.st_size > _LARGEST:
            fault = f"has {about.st_size} bytes; files of more than {_LARGEST} are not looked at"
        else:
            data = path.read_bytes()
            fault = "is binary, not the text of a .proto file" if b"\0" in data else ""
    except OSError as error:
        fault = f"cannot be read: {error.strerror}"
    if fault:
        findings.append(UNREADABLE_PROTO.at(span, fault))
        return None
    return data.decode("utf-8", errors="replace")
