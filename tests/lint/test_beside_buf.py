"""What the category WIRE of `buf breaking` finds in the mutations, our rules find, at the same places.

Where a fault is several findings of buf's, it is one of ours; `OURS_ELSEWHERE` says which those are. What lets no bytes
be misread although buf's WIRE reports it is left to `--with-buf`, as are the rules of buf's other categories.
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
from comparing import FAMILY, ROOT, changes_found, compiled
from mutations import HARMLESS, MESSAGE_SETS, MUTATIONS, Mutation, together, write

from roverlink.generator.diagnostics import Severity, Span
from roverlink.generator.lint.comparison.field_type_changes import kind
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

DOCS = Path(__file__).parents[2] / "docs"

_MEANINGS = {"WIR114", "WIR115", "WIR116"}

BUF_TO_OURS = {
    "ENUM_VALUE_NO_DELETE": {"WIR107"},
    "ENUM_VALUE_NO_DELETE_UNLESS_NAME_RESERVED": {"WIR107"},
    "ENUM_VALUE_NO_DELETE_UNLESS_NUMBER_RESERVED": {"WIR107"},
    "ENUM_VALUE_SAME_NAME": {"WIR110", "WIR116"},
    "FIELD_NO_DELETE": {"WIR102", "WIR104"},
    "FIELD_NO_DELETE_UNLESS_NAME_RESERVED": {"WIR102"},
    "FIELD_NO_DELETE_UNLESS_NUMBER_RESERVED": {"WIR102"},
    "FIELD_SAME_CARDINALITY": {"WIR103", "WIR104"},
    "FIELD_SAME_DEFAULT": {"WIR108"},
    "FIELD_SAME_NAME": _MEANINGS,
    "FIELD_SAME_ONEOF": {"WIR105"},
    "FIELD_SAME_TYPE": {"WIR101"},
    "FIELD_WIRE_COMPATIBLE_CARDINALITY": {"WIR103", "WIR104"},
    "FIELD_WIRE_COMPATIBLE_TYPE": {"WIR101"},
    "FIELD_WIRE_JSON_COMPATIBLE_CARDINALITY": {"WIR103", "WIR104"},
    "FIELD_WIRE_JSON_COMPATIBLE_TYPE": {"WIR101"},
    "MESSAGE_SAME_REQUIRED_FIELDS": {"WIR104"},
    "RESERVED_ENUM_NO_DELETE": {"WIR106"},
    "RESERVED_MESSAGE_NO_DELETE": {"WIR106"},
}
"""For each rule of buf's, those of ours that find the same at the same place."""

OURS_ELSEWHERE = {
    "FIELD_SAME_DEFAULT": {"WIR101"},  # of a field that is another one, the default is too
    "FIELD_WIRE_COMPATIBLE_TYPE": _MEANINGS,  # a map's entry has its name
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
    "FIELD_SAME_DEFAULT"  # protoc places the value, buf the word `default`
}
_SAME_BYTES = [
    *({"enum", scalar} for scalar in ("int32", "int64", "uint32", "uint64")),
    {"message"},
    {"enum"},
    {"group"},
]
"""Kinds of types that read each other's bytes; messages and enums of other names, if what is in them does."""
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
        self._about: dict[Element, set[str]] = defaultdict(set)
        for finding in self.ours:
            span = finding.span
            self._at[span.file, span.line or 1, span.column or 1].add(finding.rule.id)
            self._in_line[span.file, span.line or 1].add(finding.rule.id)
            if finding.number is not None:
                self._about[finding.type, finding.number].add(finding.rule.id)
        self._elements = _elements(self.after)

    def missed(self) -> Iterator[str]:
        """What buf's WIRE finds, and we do not."""
        for finding in self.theirs:
            beyond = finding.rule not in _of_bytes() or _OUT_OF_SCOPE.match(finding.rule)
            if not beyond and not self._is_ours(finding) and not self._misreads_nothing(finding):
                yield f"{finding.path}:{finding.line}:{finding.column} {finding.rule} {finding.message}"

    def lowered(self) -> Iterator[tuple[str, str, str]]:
        """The types before and after of what is a fault of bytes to buf's WIRE, and not to us."""
        for finding in self.theirs:
            file = f"{ROOT}/{finding.path}"
            if finding.rule == "FIELD_WIRE_COMPATIBLE_TYPE" and "WIR101" not in self._in_line[file, finding.line]:
                for owner, number in self._found_at(finding, file):
                    old, new = (_field(schema, owner, number) for schema in (self.before, self.after))
                    if old and new and old.wire_type != new.wire_type:
                        yield f"{finding.path}:{finding.line} {owner}", kind(old), kind(new)

    def graver(self) -> Iterator[str]:
        """Our errors where buf's WIRE finds nothing."""
        lines = {(f"{ROOT}/{one.path}", one.line) for one in self.theirs if one.rule in _of_bytes()}
        for finding in self.ours:
            if finding.severity is Severity.ERROR and (finding.span.file, finding.span.line) not in lines:
                yield finding.rule.id

    def _is_ours(self, finding: BufFinding) -> bool:
        file = f"{ROOT}/{finding.path}"
        if self._counts_differ(finding):
            at = self._in_line[file, finding.line]
        else:
            at = self._at[file, finding.line, finding.column]
        if at & BUF_TO_OURS[finding.rule]:
            return True
        causes = OURS_ELSEWHERE.get(finding.rule, set())
        elements = self._found_at(finding, file)
        return any(self._about[element] & causes for element in elements)

    def _misreads_nothing(self, finding: BufFinding) -> bool:
        """Whether no bytes are misread: a name is free, types read the same bytes, a oneof has the same members."""
        if finding.rule.startswith("RESERVED_"):
            return "reserved name" in finding.message
        for owner, number in self._found_at(finding, f"{ROOT}/{finding.path}"):
            old, new = (_field(schema, owner, number) for schema in (self.before, self.after))
            if old and new and finding.rule == "FIELD_WIRE_COMPATIBLE_TYPE" and {kind(old), kind(new)} in _SAME_BYTES:
                return True
            if old and new and finding.rule == "FIELD_SAME_ONEOF":
                before, after = self.before.messages[owner], self.after.messages[owner]
                known = {field.number for field in before.fields} & {field.number for field in after.fields}
                return _members(before, number) & known == _members(after, number) & known
        return False

    def _counts_differ(self, finding: BufFinding) -> bool:
        """Whether buf counts other columns than protoc."""
        text = self.mutation.after.get(finding.path, "").split("\n")
        line = text[finding.line - 1] if finding.line <= len(text) else ""
        return finding.rule in _ONLY_THE_LINE or "\t" in line or not line.isascii()

    def _found_at(self, finding: BufFinding, file: str) -> Iterable[Element]:
        """The fields and extensions that a finding may be about."""
        place = Span(file, finding.line, 0 if self._counts_differ(finding) else finding.column)
        if finding.rule == "MESSAGE_SAME_REQUIRED_FIELDS":
            return {*self._elements[place], *_required_in(self.after, finding, place)}
        return self._elements[place]


def _of_bytes() -> set[str]:
    """The rules of buf's WIRE."""
    return {rule for rule, categories in buf.categories_of_rules().items() if "WIRE" in categories}


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


def _members(message: ProtoMessage, number: int) -> set[int]:
    """The numbers of the fields that share a field's oneof, and its own."""
    oneof = next(field.oneof for field in message.fields if field.number == number)
    return {number, *(field.number for field in message.fields if field.oneof == oneof != "")}


def _required_in(after: Schema, finding: BufFinding, place: Span) -> Iterator[Element]:
    """The field that was required, in the message at a place."""
    number = re.search(r'required field "(\d+)"', finding.message)
    for message in after.messages.values():
        if number and message.span == place:
            yield message.full_name, int(number[1])


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
    """Each finding of buf's WIRE in our scope has one of ours, unless it lets no bytes be misread."""
    assert [missed for pair in pairs for missed in pair.missed()] == []


@pytest.mark.slow
@needs_buf
def test_every_rule_of_buf_is_broken(pairs: list[Pair]) -> None:
    """Among the mutations, each rule that buf has in our categories is broken; services and options are not ours."""
    rules = {rule for rule, categories in buf.categories_of_rules().items() if categories}
    broken = {finding.rule for pair in pairs for finding in pair.theirs}
    assert {rule for rule in rules if not _OUT_OF_SCOPE.match(rule)} - broken == set()


@pytest.mark.slow
@needs_buf
def test_what_buf_calls_a_fault_of_bytes_is_an_error(pairs: list[Pair]) -> None:
    """Where buf's WIRE finds another type, ours is an error, but for types that read each other's bytes."""
    assert [told for pair in pairs for told in pair.lowered() if set(told[1:]) not in _SAME_BYTES] == []


@pytest.mark.slow
@needs_buf
def test_no_error_without_a_reason(pairs: list[Pair]) -> None:
    """What is an error to us is one to buf's WIRE, or is what buf cannot see."""
    assert {id for pair in pairs for id in pair.graver()} <= ONLY_OURS


@pytest.mark.slow
def test_harmless_mutations_find_nothing(tmp_path: Path) -> None:
    """What is harmless gives no finding of ours, and none of buf's."""
    pair = Pair(together(HARMLESS), tmp_path)
    assert (pair.ours, pair.theirs) == ([], [])


@pytest.mark.slow
@needs_buf
def test_message_sets_which_buf_refuses(tmp_path: Path) -> None:
    """The option that buf does not compile is found, whether it comes or goes; buf refuses it aloud."""
    for mutation in MESSAGE_SETS:
        before = compiled(mutation.before, tmp_path / mutation.name / "before")
        after = compiled(mutation.after, tmp_path / mutation.name / "after")
        assert [finding.rule.id for finding in changes_found(before, after)] == ["WIR109"]
        with pytest.raises(buf.BufError, match="MessageSet"):
            buf.breaking(tmp_path / mutation.name / "before", tmp_path / mutation.name / "after")


def test_the_table_in_the_docs() -> None:
    """docs/lint-and-buf.md has each of our rules about changes, with buf's beside it."""
    ours = {id: rule for id, rule in lint_rules().items() if id.startswith(FAMILY)}
    rows = {row.id: row for row in _documented()}
    assert list(rows) == sorted(ours)
    for id, row in rows.items():
        assert (row.name, row.severity) == (ours[id].name, ours[id].severity.value)
        assert row.theirs == {rule for rule, known in BUF_TO_OURS.items() if id in known}, id


@pytest.mark.slow
@needs_buf
def test_the_categories_in_the_docs() -> None:
    """Buf's rules are in the categories that are told."""
    letters = {"FILE": "F", "WIRE_JSON": "J", "WIRE": "W"}
    for row in _documented():
        for rule, told in row.categories.items():
            assert sorted(told) == sorted(letters[one] for one in buf.categories_of_rules()[rule]), rule


@dataclass(frozen=True)
class Row:
    """A row of the table in the docs."""

    id: str
    name: str
    severity: str
    categories: dict[str, str]
    """Buf's rules, each with the first letters of its categories."""

    @property
    def theirs(self) -> set[str]:
        """Buf's rules."""
        return set(self.categories)


def _documented() -> Iterator[Row]:
    for line in (DOCS / "lint-and-buf.md").read_text(encoding="utf-8").splitlines():
        if found := re.match(r"\| `(...\d+)` ([a-z0-9-]+) \((\w+)\) \| [^|]+ \| ([^|]+) \|", line):
            theirs = dict(re.findall(r"`([A-Z0-9_]+)` \(([FJW ]+)\)", found[4]))
            told = {rule: categories.replace(" ", "") for rule, categories in theirs.items()}
            yield Row(found[1], found[2], found[3], told)
