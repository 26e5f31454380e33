"""Which .proto file declares which message, without compiling any.

Only the import closure of what the table names is compiled, so a file that does not compile, and that nobody needs,
does no harm.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

from generator.findings import FindingsError, Rule, Severity, Span

UNREADABLE_PROTO = Rule("PRO102", "unreadable-proto", Severity.FATAL)

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
