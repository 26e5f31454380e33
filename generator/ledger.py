"""mapping.lock, the ledger: every number ever published, and the wire schema as of the last generate.

One line a fact, so that a diff can be reviewed line by line. Numbers are only ever added; that is also why a merge
conflict in the file does no harm: reading takes the lines of both sides, and the next generate writes them in order.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from generator import ir
from generator.findings import Finding, FindingsError, Rule, Severity, Span

UNREADABLE_LEDGER = Rule("LED101", "unreadable-ledger", Severity.FATAL)
BROKEN_LEDGER = Rule("LED102", "broken-ledger")

NAME = "mapping.lock"
_HEADER = """\
# The ledger of {table}: every envelope number ever published, and the wire schema as of the last generate.
# Written by `roverlink generate`; never edited. After a merge conflict in here, run it again.
"""
_CONFLICT_END = ">>>>>>>"
_CONFLICT_MARKERS = ("<<<<<<<", "|||||||", "=======", _CONFLICT_END)
_ENTRY = re.compile(r"  (?P<number>[0-9]{1,9}): (?P<name>\w+) (?P<proto>[\w.]+)(?P<retired> retired)?")
_OTHER_LINE = re.compile(r"(#.*|version: 1|numbers:|schema:|  (message|enum) [\w.]+:|    .*)?")


@dataclass(frozen=True, slots=True)
class Entry:
    """A number that was published, and what for."""

    number: int
    name: str
    proto: str
    retired: bool
    contested: bool
    """Whether it stands on one side of a merge conflict: published by one branch, not by both."""
    span: Span


@dataclass(frozen=True, slots=True)
class Ledger:
    """Every number that was ever published, in order; a number may have been published for several payloads."""

    entries: tuple[Entry, ...] = ()


def read(path: Path, name: str = NAME) -> Ledger:
    """The ledger on disk; empty where there is none yet.

    Raises `FindingsError` where it cannot be read, or where a line is none of the ledger's.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        return Ledger()
    except OSError as error:
        raise FindingsError([UNREADABLE_LEDGER.at(Span(name), f"cannot be read: {error.strerror}")]) from error
    except UnicodeError as error:
        raise FindingsError([UNREADABLE_LEDGER.at(Span(name), f"is not UTF-8: {error}")]) from error
    entries: dict[tuple[int, str, str], Entry] = {}
    broken: list[Finding] = []
    in_conflict = False
    for index, line in enumerate(lines, 1):
        span = Span(name, index, len(line) - len(line.lstrip()) + 1)
        if line.startswith(_CONFLICT_MARKERS):
            in_conflict = not line.startswith(_CONFLICT_END)
        elif match := _ENTRY.fullmatch(line):  # in whatever section: a conflict may reach over both
            entry = _entry(match, in_conflict, span)
            entries.setdefault((entry.number, entry.name, entry.proto), entry)
        elif not _OTHER_LINE.fullmatch(line):
            help = "restore the file from version control; it is only written by `roverlink generate`"
            broken.append(BROKEN_LEDGER.at(span, f"not a line of the ledger: {line.strip()!r}", help))
    if broken:
        raise FindingsError(broken)
    return Ledger(tuple(sorted(entries.values(), key=lambda entry: (entry.number, entry.span))))


def _entry(match: re.Match[str], contested: bool, span: Span) -> Entry:
    return Entry(int(match["number"]), match["name"], match["proto"], match["retired"] is not None, contested, span)


def render(bridge: ir.Bridge) -> str:
    """The ledger's text for a table that passed the rules, which see to it that no published number is missing."""
    numbers = [(member.number, f"{member.name} {member.proto}") for member in bridge.envelope.members]
    numbers += [(retired.number, f"{retired.name} {retired.proto} retired") for retired in bridge.envelope.retired]
    lines = [_HEADER.format(table=bridge.table), "version: 1", "", "numbers:"]
    lines += [f"  {number}: {text}" for number, text in sorted(numbers)]
    lines += ["", "schema:"]
    for message in bridge.wire_messages:
        lines += [f"  message {message.name}:", *(f"    {field}" for field in message.fields)]
        lines += [f"    reserved {reserved}" for reserved in message.reserved]
    for enum in bridge.wire_enums:
        lines += [f"  enum {enum.name}:", *(f"    {value}" for value in enum.values)]
    return "\n".join(lines) + "\n"
