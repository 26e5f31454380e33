"""What `buf breaking` finds in the mutations, our rules find: at the same places, and no less grave without a reason.

Where a fault is several findings of buf's, it is one of ours; `OURS_ELSEWHERE` says which those are.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import buf
import pytest
from buf import BufFinding, needs_buf
from comparing import FAMILIES, ROOT, changes_found, compiled
from mutations import HARMLESS, MESSAGE_SETS, MUTATIONS, Mutation, together, write

from generator import rules
from generator.changes.types import kind
from generator.diagnostics import Severity, Span
from generator.protos import ProtoField, Schema

DOCS = Path(__file__).parents[2] / "docs"

_RENAMES = {"JSN104", "SRC104", "WIR114", "WIR115"}
_DELETED_FIELDS = {"WIR102", "WIR104", "JSN102", "SRC102"}
_TYPES = {"WIR101", "JSN101", "SRC101"}

BUF_TO_OURS = {
    "ENUM_NO_DELETE": {"SRC107", "SRC108"},
    "ENUM_SAME_JSON_FORMAT": {"JSN106"},
    "ENUM_SAME_TYPE": {"SRC112"},
    "ENUM_VALUE_NO_DELETE": {"WIR107", "JSN108", "SRC113"},
    "ENUM_VALUE_NO_DELETE_UNLESS_NAME_RESERVED": {"WIR107", "JSN108", "SRC113"},
    "ENUM_VALUE_NO_DELETE_UNLESS_NUMBER_RESERVED": {"WIR107"},
    "ENUM_VALUE_SAME_NAME": {"JSN107", "WIR110"},
    "EXTENSION_MESSAGE_NO_DELETE": {"SRC110"},
    "EXTENSION_NO_DELETE": {"SRC109"},
    "FIELD_NO_DELETE": _DELETED_FIELDS,
    "FIELD_NO_DELETE_UNLESS_NAME_RESERVED": {"WIR102", "JSN102", "SRC102"},
    "FIELD_NO_DELETE_UNLESS_NUMBER_RESERVED": {"WIR102"},
    "FIELD_SAME_CARDINALITY": {"WIR103", "WIR104", "JSN103", "SRC103"},
    "FIELD_SAME_CPP_STRING_TYPE": {"SRC115"},
    "FIELD_SAME_DEFAULT": {"WIR108"},
    "FIELD_SAME_JAVA_UTF8_VALIDATION": {"SRC116"},
    "FIELD_SAME_JSON_NAME": {"JSN105"},
    "FIELD_SAME_JSTYPE": {"SRC114"},
    "FIELD_SAME_NAME": _RENAMES,
    "FIELD_SAME_ONEOF": {"WIR105", "SRC106"},
    "FIELD_SAME_TYPE": _TYPES,
    "FIELD_SAME_UTF8_VALIDATION": {"SRC116"},
    "FIELD_WIRE_COMPATIBLE_CARDINALITY": {"WIR103", "WIR104"},
    "FIELD_WIRE_COMPATIBLE_TYPE": _TYPES,
    "FIELD_WIRE_JSON_COMPATIBLE_CARDINALITY": {"WIR103", "WIR104", "JSN103"},
    "FIELD_WIRE_JSON_COMPATIBLE_TYPE": _TYPES,
    "FILE_NO_DELETE": {"SRC107", "SRC108"},
    "MESSAGE_NO_DELETE": {"SRC107", "SRC108"},
    "MESSAGE_NO_REMOVE_STANDARD_DESCRIPTOR_ACCESSOR": {"SRC111"},
    "MESSAGE_SAME_JSON_FORMAT": {"JSN106"},
    "MESSAGE_SAME_REQUIRED_FIELDS": {"WIR104"},
    "ONEOF_NO_DELETE": {"SRC105"},
    "RESERVED_ENUM_NO_DELETE": {"WIR106", "JSN109"},
    "RESERVED_MESSAGE_NO_DELETE": {"WIR106", "JSN109"},
}
"""For each rule of buf's, those of ours that find the same at the same place."""

OURS_ELSEWHERE = {
    "EXTENSION_NO_DELETE": _RENAMES | {"WIR101"},  # an extension of another name is renamed, and not gone
    "FIELD_SAME_CARDINALITY": {"WIR101", "WIR105", "SRC105", "SRC106"},  # presence follows from type and oneof
    "FIELD_SAME_DEFAULT": {"WIR101"},  # of a field that is another one, the default is too
    "FIELD_SAME_JAVA_UTF8_VALIDATION": {"SRC116"},  # what holds everywhere holds in Java
    "FIELD_SAME_JSON_NAME": _RENAMES | {"WIR101"},  # JSON's name follows from the name
    "FIELD_SAME_NAME": {"WIR101"},  # of a field that is another one, the name is too
    "FIELD_SAME_ONEOF": {"SRC105"},  # that the oneof is gone is said once for all of its fields
    "FIELD_SAME_TYPE": _RENAMES | {"JSN103"},  # a map's entry has its name; a list in place of a map has its type
    "FIELD_WIRE_COMPATIBLE_TYPE": _RENAMES | {"JSN103"},
    "FIELD_WIRE_JSON_COMPATIBLE_CARDINALITY": {"WIR101"},  # a map has the type of its entry
    "FIELD_WIRE_JSON_COMPATIBLE_TYPE": _RENAMES | {"JSN103"},
    "MESSAGE_NO_DELETE": _DELETED_FIELDS | _RENAMES | _TYPES,  # the entry of a map goes with the map
    "MESSAGE_SAME_REQUIRED_FIELDS": {"WIR103", "WIR104"},  # buf has it at the message, where the field is still there
}
"""For rules of buf's that find a consequence: ours that find its cause, at another part of the same field."""

ONLY_OURS = {
    "WIR104",  # an edition's LEGACY_REQUIRED as well, which buf takes for optional
    "WIR109",  # buf compiles no message sets
    "WIR110",  # for buf, a renamed value
    "WIR111",  # buf knows two states and no ledger
    "WIR112",
    "WIR113",
    "WIR114",  # for buf, a renamed field
    "WIR115",
}
"""Errors of ours, and WIR115, that buf's WIRE has nothing for, or not always."""

_OUT_OF_SCOPE = re.compile(r"SERVICE_|RPC_|FILE_SAME_")
_ONLY_THE_LINE = {
    "FIELD_SAME_DEFAULT",  # protoc places the value, buf the word `default`
    "FIELD_SAME_CPP_STRING_TYPE",  # of `features = {...}`, protoc places the whole, buf the feature inside
}
_BYTES_OF_AN_ENUM = [{"enum", scalar} for scalar in ("int32", "int64", "uint32", "uint64")]
_OF_ANOTHER_NAME = [{"message"}, {"enum"}, {"group"}]
_ALONE = {"package_changed", "no_package", "well_known_type_not_used_any_more"}
"""Mutations that say what they say only by themselves."""
_CHUNK = 50

_BEFORE = "before"
"""How our findings call the earlier state."""

Element = tuple[str, int]


class Pair:
    """A mutation, and what buf and our rules find in it."""

    def __init__(self, mutation: Mutation, folder: Path) -> None:
        self.mutation = mutation
        self.theirs: list[BufFinding] = []
        before, after = folder / "before", folder / "after"
        if buf.executable():
            self.theirs = buf.breaking(write(mutation.before, before), write(mutation.after, after))
        self.before = compiled(mutation.before, before, _BEFORE)
        self.after = compiled(mutation.after, after)
        self.ours = changes_found(self.before, self.after)
        self._at: dict[tuple[str, int, int], set[str]] = defaultdict(set)
        self._in_line: dict[tuple[str, int], set[str]] = defaultdict(set)
        self._in_file: dict[str, set[str]] = defaultdict(set)
        self._about: dict[Element, set[str]] = defaultdict(set)
        self._about_type: dict[str, set[str]] = defaultdict(set)
        for finding in self.ours:
            span = finding.span
            self._at[span.file, span.line or 1, span.column or 1].add(finding.rule.id)
            self._in_line[span.file, span.line or 1].add(finding.rule.id)
            self._in_file[span.file].add(finding.rule.id)
            if finding.number is not None:
                self._about[finding.type, finding.number].add(finding.rule.id)
            else:
                self._about_type[finding.type].add(finding.rule.id)
        self._elements = _elements(self.after)

    def missed(self) -> Iterator[str]:
        """What buf finds, and we do not."""
        for finding in self.theirs:
            if not _OUT_OF_SCOPE.match(finding.rule) and not self._is_ours(finding):
                yield f"{finding.path}:{finding.line}:{finding.column} {finding.rule} {finding.message}"

    def lowered(self) -> Iterator[tuple[str, str, str]]:
        """The types before and after of what is a fault of bytes to buf's WIRE, and not to us."""
        for finding in self.theirs:
            if finding.rule == "FIELD_WIRE_COMPATIBLE_TYPE":
                for owner, number in self._found_at(finding, f"{ROOT}/{finding.path}"):
                    old, new = (_field(schema, owner, number) for schema in (self.before, self.after))
                    if old and new and old.wire_type != new.wire_type and "WIR101" not in self._about[owner, number]:
                        yield f"{finding.path}:{finding.line} {owner}", kind(old), kind(new)

    def graver(self) -> Iterator[str]:
        """Our errors where buf's WIRE finds nothing."""
        wire = {rule for rule, categories in buf.categories_of_rules().items() if "WIRE" in categories}
        lines = {(f"{ROOT}/{finding.path}", finding.line) for finding in self.theirs if finding.rule in wire}
        for finding in self.ours:
            if finding.severity is Severity.ERROR and (finding.span.file, finding.span.line) not in lines:
                yield finding.rule.id

    def _is_ours(self, finding: BufFinding) -> bool:
        deleted = re.match(r'Previously present file "(.*)" was deleted', finding.message)
        if deleted and deleted[1].startswith("google/protobuf/"):
            return True  # what nobody imports any more is not deleted
        file = f"{ROOT}/{finding.path}"
        if deleted:
            at = self._in_file[f"{_BEFORE}/{deleted[1]}"]
        elif self._counts_differ(finding):
            at = self._in_line[file, finding.line]
        else:
            at = self._at[file, finding.line, finding.column]
        if at & BUF_TO_OURS[finding.rule]:
            return True
        causes = OURS_ELSEWHERE.get(finding.rule, set())
        elements = self._found_at(finding, file)
        return any((self._about[element] | self._about_type[element[0]]) & causes for element in elements)

    def _counts_differ(self, finding: BufFinding) -> bool:
        """Whether buf counts other columns than protoc."""
        text = self.mutation.after.get(finding.path, "").split("\n")
        line = text[finding.line - 1] if finding.line <= len(text) else ""
        return finding.rule in _ONLY_THE_LINE or "\t" in line or not line.isascii()

    def _found_at(self, finding: BufFinding, file: str) -> Iterable[Element]:
        """The fields and extensions that a finding may be about."""
        if finding.rule == "MESSAGE_NO_DELETE":
            return _maps_of_entry(self.before, finding)
        if finding.rule == "EXTENSION_NO_DELETE":
            name = _quoted(finding).rpartition(".")[2]
            return [(e.extendee, e.field.number) for e in self.before.extensions if e.field.name == name]
        place = Span(file, finding.line, 0 if self._counts_differ(finding) else finding.column)
        if finding.rule == "MESSAGE_SAME_REQUIRED_FIELDS":
            return {*self._elements[place], *_required_in(self.after, finding, place)}
        return self._elements[place]


def _elements(schema: Schema) -> dict[Span, set[Element]]:
    """The fields and extensions at each place, and in each line."""
    elements: dict[Span, set[Element]] = defaultdict(set)
    fields: list[tuple[str, ProtoField]] = [
        (m.full_name, field) for m in schema.messages.values() for field in m.fields
    ]
    for owner, field in [*fields, *((extension.extendee, extension.field) for extension in schema.extensions)]:
        for span in (field.span, *field.places.values()):
            elements[span].add((owner, field.number))
            elements[Span(span.file, span.line)].add((owner, field.number))
    return elements


def _field(schema: Schema, owner: str, number: int) -> ProtoField | None:
    fields = schema.messages[owner].fields if owner in schema.messages else ()
    return next((field for field in fields if field.number == number), None)


def _maps_of_entry(before: Schema, finding: BufFinding) -> Iterator[Element]:
    """The map whose entry a finding calls deleted."""
    for message in before.messages.values():
        if message.map_entry and message.file == finding.path and message.full_name.endswith(f".{_quoted(finding)}"):
            owner = before.messages[message.full_name.rpartition(".")[0]]
            yield from ((owner.full_name, one.number) for one in owner.fields if one.type_name == message.full_name)


def _required_in(after: Schema, finding: BufFinding, place: Span) -> Iterator[Element]:
    """The field that was required, in the message at a place."""
    number = re.search(r'required field "(\d+)"', finding.message)
    for message in after.messages.values():
        if number and message.span == place:
            yield message.full_name, int(number[1])


def _quoted(finding: BufFinding) -> str:
    found = re.search(r'"([^"]*)"', finding.message)
    return found[1] if found else ""


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> list[Pair]:
    """All mutations, many as one where that says the same."""
    many = [mutation for mutation in MUTATIONS if mutation.name not in _ALONE]
    chunks: Sequence[Mutation] = [together(many[start : start + _CHUNK]) for start in range(0, len(many), _CHUNK)]
    chunks = [*chunks, *(mutation for mutation in MUTATIONS if mutation.name in _ALONE)]
    folders = [tmp_path_factory.mktemp("pair") for _ in chunks]  # which is nothing for threads
    with ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(Pair, chunks, folders))


@pytest.mark.slow
@needs_buf
def test_what_buf_finds_we_find(pairs: list[Pair]) -> None:
    """Each finding of buf's in our scope has one of ours."""
    assert [missed for pair in pairs for missed in pair.missed()] == []


@pytest.mark.slow
@needs_buf
def test_what_buf_calls_a_fault_of_bytes_is_an_error(pairs: list[Pair]) -> None:
    """Where buf's WIRE finds another type, ours is an error, but for types that read each other's bytes."""
    harmless = [*_BYTES_OF_AN_ENUM, *_OF_ANOTHER_NAME]
    assert [told for pair in pairs for told in pair.lowered() if set(told[1:]) not in harmless] == []


@pytest.mark.slow
@needs_buf
def test_no_error_without_a_reason(pairs: list[Pair]) -> None:
    """What is an error to us is one to buf's WIRE, or is what buf cannot see."""
    assert {id for pair in pairs for id in pair.graver()} <= ONLY_OURS


def test_harmless_mutations_find_nothing(tmp_path: Path) -> None:
    """What is harmless gives nothing above a hint."""
    pair = Pair(together(HARMLESS), tmp_path)
    assert [finding.render() for finding in pair.ours if finding.severity is not Severity.HINT] == []


def test_message_sets_which_buf_refuses(tmp_path: Path) -> None:
    """The option that buf does not compile is found, whether it comes or goes."""
    for mutation in MESSAGE_SETS:
        before = compiled(mutation.before, tmp_path / mutation.name / "before")
        after = compiled(mutation.after, tmp_path / mutation.name / "after")
        assert [finding.rule.id for finding in changes_found(before, after)] == ["WIR109"]


def test_the_table_in_the_docs() -> None:
    """docs/lint.md has each of our rules about changes, with buf's beside it."""
    ours = {id: module.RULE for id, module in rules.modules().items() if id.startswith(FAMILIES)}
    rows = {row.id: row for row in _documented()}
    assert list(rows) == sorted(ours, key=lambda rule: (FAMILIES.index(rule[:3]), rule))
    for id, row in rows.items():
        assert (row.name, row.severity) == (ours[id].name, ours[id].severity.value)
        assert row.theirs == {rule for rule, known in BUF_TO_OURS.items() if id in known}, id


@pytest.mark.slow
@needs_buf
def test_the_examples_in_the_docs(pairs: list[Pair]) -> None:
    """Each example has the finding that it is to show, and buf's rules are in the categories that are told."""
    found = {(finding.rule.id, finding.span.file.split("/")[1]) for pair in pairs for finding in pair.ours}
    letters = {"FILE": "F", "WIRE_JSON": "J", "WIRE": "W"}
    for row in _documented():
        assert row.example == "" or (row.id, row.example) in found, row
        for rule, told in row.categories.items():
            assert sorted(told) == sorted(letters[one] for one in buf.categories_of_rules()[rule]), rule


@dataclass(frozen=True)
class Row:
    """A row of the table in the docs."""

    id: str
    name: str
    severity: str
    example: str
    """A mutation; empty where none shows it."""
    categories: dict[str, str]
    """Buf's rules, each with the first letters of its categories."""

    @property
    def theirs(self) -> set[str]:
        """Buf's rules."""
        return set(self.categories)


def _documented() -> Iterator[Row]:
    for line in (DOCS / "lint.md").read_text(encoding="utf-8").splitlines():
        if found := re.match(r"\| `(...\d+)` ([a-z0-9-]+) \((\w+)\) \| [^|]+ \| (?:`(\w+)`|-) \| ([^|]+) \|", line):
            theirs = dict(re.findall(r"`([A-Z0-9_]+)` \(([FJW ]+)\)", found[5]))
            told = {rule: categories.replace(" ", "") for rule, categories in theirs.items()}
            yield Row(found[1], found[2], found[3], found[4] or "", told)
