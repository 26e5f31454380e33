"""Which .proto file declares which message and imports which files, without compiling any.

Only the import closure of what the table names is compiled, so a file that does not compile, and that nobody needs,
does no harm.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from generator.diagnostics import Diagnostic, DiagnosticsError, Span, shown
from generator.proto_rules import UNREADABLE_PROTO

_LARGEST = 4 * 1024 * 1024  # bytes; the largest that people write have a few hundred thousand

_TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?|[A-Za-z_][\w.]*|[{};=]""", re.DOTALL
)
_QUOTES = "\"'"
_DEEPEST = 32  # protoc takes no more messages in messages


@dataclass(frozen=True, slots=True)
class DeclarationIndex:
    """Which files, relative to the root, declare a message of a name."""

    files: Mapping[str, Sequence[str]]
    excluded: Mapping[str, Sequence[str]]
    """Of the files that never take part in a build."""


def index_declarations(root: Path, exclude: Iterable[str], shown_root: str) -> DeclarationIndex:
    """The index of a tree; ``shown_root`` is how findings call the root.

    Raises `DiagnosticsError` for what cannot be read.
    """
    left_out = {str(PurePosixPath(path)) for path in exclude}
    files: dict[str, list[str]] = {}
    excluded: dict[str, list[str]] = {}
    findings: list[Diagnostic] = []
    for name in proto_files(root, shown_root, findings):
        target = excluded if name in left_out else files
        for declared in sorted(set(declared_names(read_proto(root, name, shown_root, findings) or ""))):
            target.setdefault(declared, []).append(name)
    if findings:
        raise DiagnosticsError(findings)
    return DeclarationIndex(files, excluded)


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


def read_protos(root: Path, names: Iterable[str], shown_root: str, findings: list[Diagnostic]) -> dict[str, str]:
    """The texts of those of the .proto files that have one; any other is a finding."""
    texts = {name: read_proto(root, name, shown_root, findings) for name in names}
    return {name: text for name, text in texts.items() if text is not None}


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


def declared_names(text: str) -> Iterator[str]:
    """The full names of the messages that a .proto file declares, nested ones included."""
    words = _words(text)
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


def imported_files(text: str) -> Iterator[str]:
    """The paths that a .proto file imports, as they are written."""
    path: str | None = None  # None: this is no import statement
    for word in _words(text):
        if word == "import":
            path = ""
        elif path is not None and word[0] in _QUOTES:
            path += word.strip(_QUOTES)
        elif path or word not in ("public", "weak"):
            if path:
                yield path
            path = None


def _words(text: str) -> list[str]:
    return [word for word in _TOKEN.findall(text) if not word.startswith(("//", "/*"))]
