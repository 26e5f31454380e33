"""Finder of commented-out fields and enum values, such as ``// float speed = 4;``. They are called claims.

Teams often comment a field out instead of reserving its number. The number is then still in use on robots that run old
firmware, so the rules of the lint look at claims.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.parser.phrases import number_of
from roverlink.generator.protos.parser.tokens import Comment, Place
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField

_DECORATION = re.compile(r"[\s/*!-]*")
_SPACE = re.compile(r"\s*")
_BLOCK = re.compile(r"(?P<kind>message|enum|extend|service|rpc|oneof)\s+(?P<name>[\w.]+)[^{};=]*\{")
# A comment is prose until it proves to be a declaration. Therefore both patterns need everything up to the `;` or the
# `[` of options: "the speed = 4 m/s" is prose, "float speed = 4;" is a claim.
_FIELD = re.compile(
    r"(?:(?:optional|required|repeated)\s+)?(?P<type>map\s*<[^<>]*>|\.?[A-Za-z_][\w.]*)\s+"
    r"(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<number>[0-9]\w*)\s*[;\[]"
)
_VALUE = re.compile(r"(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<number>-?[0-9]\w*)\s*[;\[]")
# `option x = 1;` and `return x = 1;` look like fields. These words are not types.
_NO_TYPES = frozenset(
    ["option", "syntax", "edition", "package", "import", "reserved", "extensions", "return", "const", "let", "var"]
)


def claimed_fields(text: str, comments: Iterable[Comment], oneof: str) -> Iterator[ProtoField]:
    """Yield the commented-out fields in comments of a message, or of its oneof ``oneof``.

    ``text`` is the text of the whole file.
    """
    for match, number, within, span in _claims(text, comments, _FIELD, oneof):
        type = " ".join(match["type"].split())
        if type not in _NO_TYPES:
            yield ProtoField(span=span, number=number, name=match["name"], type=type, oneof=within)


def claimed_values(text: str, comments: Iterable[Comment]) -> Iterator[ProtoEnumValue]:
    """Yield the commented-out values in comments of an enum; ``text`` is the text of the whole file."""
    for match, number, _, span in _claims(text, comments, _VALUE, ""):
        yield ProtoEnumValue(span=span, number=number, name=match["name"])


_Claim = tuple[re.Match[str], int, str, Span]
"""A commented-out declaration: the regular expression's match, the number, the oneof and the place."""


def _claims(text: str, comments: Iterable[Comment], claim: re.Pattern[str], oneof: str) -> Iterator[_Claim]:
    reader = _Reader(claim, oneof)
    for comment in comments:
        yield from reader.comment(text, comment)


class _Reader:
    """Reader of comments that finds commented-out declarations.

    It reads adjacent comments together, because a commented-out message may span many comments.
    """

    def __init__(self, claim: re.Pattern[str], oneof: str) -> None:
        self._claim = claim
        self._blocks: list[str | None] = [oneof]
        """The commented-out blocks around a line: each the name of a oneof, or None if fields inside do not count."""

    def comment(self, text: str, comment: Comment) -> Iterator[_Claim]:
        place = Place(text, comment.start, comment.line, comment.column)
        start = comment.start
        for line in text[comment.start : comment.end].split("\n"):
            for match in self._line(line):
                place.move_to(start + match.start())
                claim = self._claim_of(match, place)
                if claim:
                    yield claim
            start += len(line) + 1

    def _line(self, line: str) -> Iterator[re.Match[str]]:
        """Yield the matches of declarations in a line of a comment, up to the first part that is no declaration."""
        offset = _end(_DECORATION, line, 0)
        while offset < len(line):
            if match := _BLOCK.match(line, offset):
                self._blocks.append(match["name"] if match["kind"] == "oneof" else None)
                offset = match.end()
            elif line[offset] == "}":
                if len(self._blocks) > 1:
                    self._blocks.pop()
                offset += 1
            elif match := self._claim.match(line, offset):
                yield match
                # Go on behind the options, if there are any; several declarations may share a line.
                offset = line.find(";", match.end() - 1) + 1 or len(line)
            else:
                return
            offset = _end(_SPACE, line, offset)

    def _claim_of(self, match: re.Match[str], place: Place) -> _Claim | None:
        oneof, number = self._blocks[-1], number_of(match["number"].removeprefix("-"))
        if oneof is None or number is None:
            return None
        signed = -number if match["number"].startswith("-") else number
        return match, signed, oneof, Span("", place.line, place.column)


def _end(pattern: re.Pattern[str], line: str, offset: int) -> int:
    match = pattern.match(line, offset)
    return match.end() if match else offset
