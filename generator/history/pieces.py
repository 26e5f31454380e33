"""Pieces of a file: what stands between the ends of two statements, the second end included.

In a block whose braces match, a statement says what it says whatever stands around it. That is what makes it safe to
read it alone, in an empty block of the same kind; the tests hold that against `parse` on the whole.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from generator.declarations import Enum, File, Message, parse
from generator.history.facts import facts_of
from generator.history.model import Fact

_LEAD = re.compile(r"(?:[ \t\r\n\v\f]+|//[^\n]*|/\*[\s\S]*?\*/)*")
_OPENING = re.compile(r"(message|enum|oneof|service)[ \t]+([A-Za-z_]\w*)\s*\{", re.ASCII)
_RPC = re.compile(r"[ -~\s]*", re.ASCII)
_OPTION = r"[ \t]*\(?[A-Za-z_][\w.]*\)?(?:\.[\w.]+)?[ \t]*=[ \t]*-?\w+[ \t]*"
_NUMBER = r"(0|-?[1-9]\d{0,9})[ \t]*(?:\[" + _OPTION + r"(?:," + _OPTION + r")*\][ \t]*)?;"
_FIELD = re.compile(
    r"(?:(optional|required|repeated)[ \t]+)?(\.?[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)[ \t]+([A-Za-z_]\w*)[ \t]*=[ \t]*"
    + _NUMBER,
    re.ASCII,
)
_VALUE = re.compile(r"([A-Za-z_]\w*)[ \t]*=[ \t]*" + _NUMBER, re.ASCII)
_NO_TYPES = frozenset(
    [
        *(
            "message",
            "enum",
            "service",
            "oneof",
            "optional",
            "required",
            "repeated",
            "reserved",
            "extensions",
            "extend",
        ),
        *("option", "group", "map", "import", "syntax", "edition", "package", "export", "local"),
    ]
)
# In what is broken, these may be the beginning of something that a statement of its own would not show.
_BLOCK_WORD = re.compile(r"\b(?:message|enum|service|oneof|extend|group|import|syntax|edition|package)\b")
_MAY_OPEN = {"file": ("message", "enum", "service"), "message": ("message", "enum", "oneof")}


@dataclass(frozen=True, slots=True)
class Piece:
    """What a piece says."""

    lines: int
    """How many line ends it has."""
    facts: tuple[tuple[int, Fact], ...] = ()
    """Each with the line of the piece, from 0, on which it stands."""
    line: int = 0
    """The line on which its statement begins."""
    opens: str = ""
    """The kind of block that it opens; empty for none."""
    name: str = ""
    """That of the type that it opens."""
    closes: bool = False
    package: str = ""
    broken: bool = False
    effect: bool = False
    """Whether it does anything but state facts."""


class Pieces:
    """The pieces read in one kind of block: ``file``, ``message``, ``enum``, ``service``, or ``oneof`` and a name."""

    def __init__(self, context: str) -> None:
        self._context, _, self._oneof = context.partition(" ")
        self._in_file, self._in_service = context == "file", context == "service"
        self._read: dict[str, Piece | None] = {}

    def read(self, text: str) -> Piece | None:
        """What a piece says; None where that depends on what is around it."""
        try:
            return self._read[text]
        except KeyError:
            piece = self._read[text] = self._piece(text)
            return piece

    def _piece(self, text: str) -> Piece | None:
        match = _LEAD.match(text)
        lead = match.group() if match else ""
        rest = text[len(lead) :]
        if not rest:
            return Piece(text.count("\n")) if self._in_file else None
        if rest[-1] not in ";{}" or "\ufeff" in rest:  # which at the very beginning, and nowhere else, is nothing
            return None
        if self._in_service:
            return _of_service(text, rest)
        if rest[-1] == ";":
            return self._statement(text, lead, rest)
        if rest == "}":
            claims = self._claims(lead)
            return Piece(text.count("\n"), claims, closes=True, effect=True) if not self._in_file else None
        return self._opening(text, lead, rest)

    def _opening(self, text: str, lead: str, rest: str) -> Piece | None:
        match = _OPENING.fullmatch(rest)
        if match is None or match[1] not in _MAY_OPEN.get(self._context, ()):
            return None
        oneof, known = match[1] == "oneof", match[1] != "service"
        return Piece(
            text.count("\n"),
            self._claims(lead),
            lead.count("\n"),
            opens=f"oneof {match[2]}" if oneof else match[1],
            name=match[2] if known and not oneof else "",
            effect=True,
        )

    def _claims(self, lead: str) -> tuple[tuple[int, Fact], ...]:
        """What is commented out before a brace."""
        if "=" not in lead or self._in_file:
            return ()
        alone = self._alone(lead, lead)
        return alone.facts if alone else ()

    def _statement(self, text: str, lead: str, rest: str) -> Piece | None:
        plain = None if "=" in lead or self._in_file else self._plain(rest)
        if plain is None:
            return self._alone(text, rest)
        return Piece(text.count("\n"), ((lead.count("\n"), plain),))

    def _plain(self, rest: str) -> Fact | None:
        """A field or an enum value without anything that would need a second look."""
        if self._context == "enum":
            value = _VALUE.fullmatch(rest)
            return Fact(int(value[2]), value[1], "") if value else None
        field = _FIELD.fullmatch(rest)
        if field is None or field[2] in _NO_TYPES or field[4].startswith("-"):
            return None
        return Fact(int(field[4]), field[3], field[2], field[1] or "", self._oneof)

    def _alone(self, text: str, rest: str) -> Piece | None:
        """What `parse` says of a piece in a block that holds nothing else."""
        file = parse({"file": text, "enum": f"enum E {{{text}}}"}.get(self._context) or self._in_message(text))
        if file.broken and _BLOCK_WORD.search(rest):
            return None
        if file.extends or len(file.messages) + len(file.enums) != (not self._in_file):
            return None
        lines = text.count("\n")
        if self._in_file:
            return Piece(lines, package=file.package, broken=file.broken, effect=file.broken or bool(file.package))
        return Piece(lines, _facts(file), broken=file.broken, effect=file.broken)

    def _in_message(self, text: str) -> str:
        return f"message M {{ oneof {self._oneof} {{{text}}}}}" if self._oneof else f"message M {{{text}}}"


def _facts(file: File) -> tuple[tuple[int, Fact], ...]:
    """The facts of the only type in a file, each with its line from 0."""
    types: list[Message | Enum] = [*file.messages, *file.enums]
    return tuple((line - 1, fact) for type in types for fact, line in facts_of(type))


def _of_service(text: str, rest: str) -> Piece | None:
    """In a service, only braces count."""
    if not _RPC.fullmatch(rest):
        return None
    opens = "service" if rest[-1] == "{" else ""
    closes = rest[-1] == "}"
    return Piece(text.count("\n"), opens=opens, closes=closes, effect=bool(opens or closes))
