"""Reader of the files mapping.lock and accepted-numbers.lock. It returns a `Ledger`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set
from dataclasses import dataclass, field
from pathlib import Path

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.git import Repository
from roverlink.generator.ledger_names import LEDGER as NAME
from roverlink.generator.lock.ledger import Burned, Entry, Ledger, PastUse, Settled, checksum
from roverlink.generator.lock.ledger_rules import BrokenLedger, DeletedLedger, EditedLedger, UnreadableLedger
from roverlink.generator.lock.row_settings import AMOUNTS, EXTRA_TOPIC, FORWARD, REQUESTS, Setting
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, ProtoField, ProtoMessage, Schema

_CONFLICT_END = ">>>>>>>"
_CONFLICT_MARKERS = ("<<<<<<<", "|||||||", "=======", _CONFLICT_END)
_RESTORE = "restore the file from version control; only roverlink may change it"
_TYPE = r"[A-Za-z_][\w.]*"
# Field numbers have at most nine digits (2**29 - 1), enum values ten and a sign (int32). A longer number is no entry.
_ENTRY = re.compile(
    rf"  (?P<number>[0-9]{{1,9}}): (?P<name>\w+) (?P<proto>{_TYPE})(?: on (?P<topic>\S+))?(?P<end> retired| gone)?"
)
_SETTING = re.compile(
    rf"  (?P<number>[0-9]{{1,9}}) (?P<proto>{_TYPE}) "
    rf"(?:(?P<measure>{'|'.join(AMOUNTS)}|{FORWARD}[a-z]\w* (?:max_rate|at_least)): (?P<amount>[0-9]{{1,9}}(?:ms)?)"
    rf"|(?P<key>direction|ros|qos|forward|deadman send|{'|'.join(REQUESTS)}"
    rf"|{EXTRA_TOPIC}\S+?(?: qos)?): (?P<text>.+))"
)
_OWNER = re.compile(rf"  (?P<kind>message|enum) (?P<name>{_TYPE}):")
_FIELD = re.compile(
    rf"    (?P<number>[0-9]{{1,9}}) (?P<name>\w+) (?:(?P<label>optional|required|repeated) )?(?P<type>{_TYPE})"
    r"(?: in (?P<oneof>\w+))?(?P<gone> gone)?"
)
_VALUE = re.compile(r"    (?P<number>-?[0-9]{1,10}) (?P<name>\w+)(?P<gone> gone)?")
_RESERVED = re.compile(r'    reserved (?:(?P<first>-?[0-9]{1,10})(?: to (?P<last>-?[0-9]{1,10}))?|"(?P<name>[^"]+)")')
_CHECKSUM = re.compile(r"checksum: (?P<digest>[0-9a-f]+)")
_BURNED = re.compile(rf"  (?P<owner>{_TYPE}) (?P<number>-?[0-9]{{1,10}}): (?P<uses>\S.*?)(?: -- (?P<reason>\S.*))?")
_USE = re.compile(r"(?:(?P<type>\S.*) )?(?P<name>\w+)(?: #(?P<content>[0-9a-f]+))?")
_NOW = " now"
_FILE = re.compile(r"  file (?P<path>\S.*)")
_SETTLED = re.compile(r"  rule (?P<rule>[A-Z]{3}[0-9]{3})(?: (?P<subject>(?!-- )\S.*?))?(?: -- (?P<reason>\S.*))?")
_OTHER_LINE = re.compile(r"(#.*|version: 1|numbers:|rows:|schema:|burned:|lint:|files:)?")


def read(path: Path, findings: list[Diagnostic], name: str = NAME) -> Ledger:
    """Read the ledger from a file. The ledger is empty if the file does not exist yet.

    Adds a diagnostic to ``findings`` for a file that cannot be read, a line with wrong syntax, a wrong checksum, and a
    file that was deleted since git's last commit. Correct lines are still read. ``name`` is the file's name in
    diagnostics.
    """
    try:
        text = source_files.read_text(path.parent, path.name)
    except FileNotFoundError:
        if Repository(path.parent).has("HEAD", path.name):
            message = "the ledger was deleted; without it, the numbers in it look free"
            findings.append(DeletedLedger.at(Span(name), message, _RESTORE))
        return Ledger()
    except OSError as error:
        message = f"the ledger cannot be read: {error.strerror}"
        findings.append(UnreadableLedger.at(Span(name), message, _RESTORE))
        return Ledger()
    except UnicodeDecodeError as error:
        message = f"the ledger is not UTF-8 text (wrong byte at offset {error.start})"
        findings.append(UnreadableLedger.at(Span(name), message, _RESTORE))
        return Ledger()
    reader = _Reader()
    for index, line in enumerate(text.splitlines(), 1):
        reader.line(line, Span(name, index, len(line) - len(line.lstrip()) + 1))
    if not reader.broken and not reader.merged and checksum(text.rpartition("checksum:")[0]) != reader.checksum:
        message = "the checksum is wrong: the file was edited, or a part of it is missing"
        reader.broken.append(EditedLedger.at(Span(name), message, _RESTORE))
    findings += reader.broken
    return reader.ledger()


@dataclass(slots=True)
class _Type:
    """Section of mapping.lock for one message or enum, while its lines are being read."""

    of_message: bool
    span: Span
    numbers: list[tuple[re.Match[str], Span]] = field(default_factory=list)
    reserved: list[tuple[int, int]] = field(default_factory=list)
    reserved_names: list[str] = field(default_factory=list)
    places: dict[str, Span] = field(default_factory=dict)

    def add(self, match: re.Match[str], span: Span) -> None:
        """Add a line of the section: a field, an enum value, or a reserved range or name."""
        if match.re is not _RESERVED:
            self.numbers.append((match, span))
        elif match["name"]:
            self.reserved_names.append(match["name"])
            self.places[f"reserved {match['name']}"] = span
        else:
            first = int(match["first"])
            self.reserved.append((first, int(match["last"] or first)))
            self.places[f"reserved {first} to {self.reserved[-1][1]}"] = span

    def fields(self, gone: bool, messages: Set[str], enums: Set[str]) -> Iterator[ProtoField]:
        """Yield the current fields of the message, or with ``gone`` the fields that do not exist any more.

        ``messages`` and ``enums`` have the names of all messages and enums: a type in neither is a scalar.
        """
        for match, span in self.numbers:
            if (match["gone"] is not None) is gone:
                type = match["type"]
                kind = "message" if type in messages else "enum" if type in enums else ""
                label, oneof = match["label"] or "", match["oneof"] or ""
                yield ProtoField(
                    span=span,
                    number=int(match["number"]),
                    name=match["name"],
                    type=kind or type,
                    type_name=type if kind else "",
                    # The ledger leaves out the label where presence follows from the type (`ProtoField.on_the_wire`);
                    # protoc writes it.
                    label="optional" if not label and (kind == "message" or oneof) else label,
                    oneof=oneof,
                )

    def values(self, gone: bool) -> Iterator[ProtoEnumValue]:
        """Yield the current values of the enum, or with ``gone`` the values that do not exist any more."""
        for match, span in self.numbers:
            if (match["gone"] is not None) is gone:
                yield ProtoEnumValue(span=span, name=match["name"], number=int(match["number"]))


class _Reader:
    """Reader of mapping.lock, line by line. In a merge conflict, it accepts the lines of both sides."""

    def __init__(self) -> None:
        self._entries: dict[tuple[int, str, str], Entry] = {}
        self._settings: dict[tuple[int, str], dict[str, Setting]] = {}
        self._messages: dict[str, _Type] = {}
        self._enums: dict[str, _Type] = {}
        self._type: _Type | None = None
        self._burned: dict[tuple[str, int], Burned] = {}
        self._settled: dict[tuple[str, str], Settled] = {}
        self._files: dict[str, None] = {}
        self._in_conflict = False
        self._one_sided: set[tuple[int, str]] = set()
        self.merged = False
        """True if the file contains a merge conflict. Then its checksum is not checked."""
        self.checksum = ""
        self.broken: list[Diagnostic] = []

    def ledger(self) -> Ledger:
        """Return the ledger that the lines read so far describe."""
        entries = sorted(self._entries.values(), key=lambda entry: (entry.number, entry.span))
        burned = tuple(burned for _, burned in sorted(self._burned.items()))
        messages = {name: self._message(name, type) for name, type in self._messages.items()}
        enums = {name: _enum(name, type) for name, type in self._enums.items()}
        gone_fields = {name: self._fields(type, gone=True) for name, type in self._messages.items()}
        gone_values = {name: tuple(type.values(gone=True)) for name, type in self._enums.items()}
        return Ledger(
            tuple(entries),
            Schema((), messages, enums),
            gone_fields,
            gone_values,
            burned,
            tuple(sorted(self._settled.values())),
            self._settings,
            tuple(self._files),
        )

    def _fields(self, type: _Type, gone: bool) -> tuple[ProtoField, ...]:
        return tuple(type.fields(gone, self._messages.keys(), self._enums.keys()))

    def _message(self, name: str, type: _Type) -> ProtoMessage:
        fields = self._fields(type, gone=False)
        return ProtoMessage(
            span=type.span,
            places=type.places,
            full_name=name,
            fields=fields,
            oneofs=tuple(dict.fromkeys(field.oneof for field in fields if field.oneof)),
            reserved=tuple(type.reserved),
            reserved_names=tuple(type.reserved_names),
        )

    def line(self, line: str, span: Span) -> None:
        """Read one line of the file. Lines between the markers of a merge conflict are read too, from both sides."""
        if line.startswith(_CONFLICT_MARKERS):
            # The checksum of a file with conflict markers belongs to neither side, so it is not compared.
            self._in_conflict, self.merged = not line.startswith(_CONFLICT_END), True
        elif match := _ENTRY.fullmatch(line):
            self._add_entry(match, span)
        elif match := _SETTING.fullmatch(line):
            if self._is_published(None, line):
                row = self._settings.setdefault((int(match["number"]), match["proto"]), {})
                row[match["measure"] or match["key"]] = Setting(match["amount"] or match["text"], span)
        elif match := _OWNER.fullmatch(line):
            of_message = match["kind"] == "message"
            types = self._messages if of_message else self._enums
            self._type = types.setdefault(match["name"], _Type(of_message, span))
        elif (match := _BURNED.fullmatch(line)) and (burned := _burned(match)):
            key = burned.owner, burned.number
            self._burned[key] = burned.joined(self._burned.get(key))
        elif match := _SETTLED.fullmatch(line):
            settled = Settled(match["rule"], match["subject"] or "", match["reason"] or "")
            self._settled[settled.rule, settled.subject] = settled
        elif match := _FILE.fullmatch(line):
            self._files[match["path"]] = None
        elif match := _CHECKSUM.fullmatch(line):
            self.checksum = match["digest"]
        elif not self._add_fact(line, span) and not _OTHER_LINE.fullmatch(line):
            self.broken.append(
                BrokenLedger.at(span, f"this line does not belong to a ledger: {line.strip()!r}", _RESTORE)
            )

    def _add_entry(self, match: re.Match[str], span: Span) -> None:
        entry = Entry(
            int(match["number"]),
            match["name"],
            match["proto"],
            match["topic"] or "",
            match["end"] == " retired",
            self._in_conflict,
            span,
            gone=match["end"] == " gone",
        )
        self._entries.setdefault((entry.number, entry.name, entry.proto), entry)

    def _add_fact(self, line: str, span: Span) -> bool:
        """Read a line about a field, an enum value or a reservation of the current message or enum.

        Returns False if the line has another form.
        """
        type = self._type
        pattern = (_FIELD if type.of_message else _VALUE) if type else None
        match = (_RESERVED.fullmatch(line) or pattern.fullmatch(line)) if pattern else None
        if type is None or match is None:
            return False
        if self._is_published(type, line):
            type.add(match, span)
        return True

    def _is_published(self, type: _Type | None, line: str) -> bool:
        """Return True if a line is outside of merge conflicts, or stands on both sides of one.

        A line on one side only was published by one branch. The merged table and .proto files decide if it is still
        valid. ``type`` is the message or enum to which the line belongs; None for a setting of a row.
        """
        if not self._in_conflict:
            return True
        seen_before = (id(type), line) in self._one_sided
        self._one_sided.add((id(type), line))
        return seen_before


def _burned(match: re.Match[str]) -> Burned | None:
    """Return the burned number in a line; None if one of its meanings has another form."""
    texts = match["uses"].split(" | ")
    uses = [_use(text.removesuffix(_NOW)) for text in texts]
    now = next((use for use, text in zip(uses, texts, strict=True) if text.endswith(_NOW)), None)
    known = tuple(use for use in uses if use)
    return Burned(match["owner"], int(match["number"]), known, now, match["reason"] or "") if all(uses) else None


def _use(text: str) -> PastUse | None:
    match = _USE.fullmatch(text)
    # Earlier versions of roverlink wrote types as the .proto file did, which may start with a dot.
    return PastUse((match["type"] or "").lstrip("."), match["name"], match["content"] or "") if match else None


def _enum(name: str, type: _Type) -> ProtoEnum:
    return ProtoEnum(
        span=type.span,
        places=type.places,
        full_name=name,
        values=tuple(type.values(gone=False)),
        reserved=tuple(type.reserved),
        reserved_names=tuple(type.reserved_names),
    )
