"""Context of a lint: all data that the rules may look at, such as the table, the .proto files, and earlier states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from roverlink.generator.diagnostics import Diagnostic, Rule, Span, shown
from roverlink.generator.git import Commit
from roverlink.generator.ir.protobuf_facts import IMPLEMENTATION_NUMBERS, LARGEST_FIELD_NUMBER
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.history import whereabouts
from roverlink.generator.lint.pinned_states import PinnedStates
from roverlink.generator.lock import Entry, Ledger, RowSettings, Setting, settings_of_row, settings_of_rows, topics_of
from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.parser import File
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.protos.uncompiled import ReadFiles, read_alike
from roverlink.generator.table import Row, Table

if TYPE_CHECKING:
    from roverlink.generator.lint.history import History


def since_last_generate(published: Ledger, schema: Schema, incomplete: str = "") -> tuple[SchemaChange, ...]:
    """Return the change from the ledger's schema (mapping.lock, at the last ``generate``) to the current ``schema``.

    The tuple has one item; it is empty if the ledger has no entries. ``incomplete`` is the full name of a message that
    lacks fields in ``schema``, because a row of the table has a mistake. This message is not compared.
    """
    if not published.entries:
        return ()
    before = published.schema
    known = {name: message for name, message in before.messages.items() if name != incomplete}
    return (SchemaChange(replace(before, messages=known), schema, of_ledger=True),)


@dataclass(frozen=True, slots=True)
class Past:
    """History of the .proto files in git, and the checks of this history that the user requested."""

    history: History
    of_numbers: bool = False
    """True if the user requested the check of every number's history (``--history``)."""
    of_branches: bool = False
    """True if the user requested the comparison of branches that are not merged yet (``--branches``)."""
    pinned: PinnedStates | None = None
    """The .proto files that other projects use, compared with those of today (``--pins``); None if not requested."""
    pinned_before: PinnedStates | None = None
    """The same, with the baseline in place of today's files; None without a baseline (``--against``)."""
    change: frozenset[str] | None = None
    """Ids of the commits since the baseline's commit; None if no commit is the baseline (``--against``)."""

    def is_new(self, commit: Commit) -> bool:
        """Return True if a commit belongs to the change since the baseline, or is not made yet."""
        return not commit.id or commit.id in (self.change or ())

    def is_known(self, *causes: Commit) -> bool:
        """Return True if none of the commits that cause a fault belongs to the change since the baseline.

        Then the baseline has the fault already, or it is the business of a branch that somebody else has open.
        """
        return self.change is not None and not any(map(self.is_new, causes))

    def taken(self, envelope: str) -> dict[int, str]:
        """Return every number that the envelope ever had on any branch, with a text that says which field had it.

        ``envelope`` is the full name of the envelope's message. The text continues a sentence that starts with the
        number: ``is 'imu_info' (ImuInfo) on the branch main``. Numbers of commented-out fields are included.
        """
        taken: dict[int, str] = {}
        for number, usages in self.history.claims(envelope).items():
            taken[number] = f"was the number of the commented-out field {usages[-1].name!r} ({usages[-1].came})"
        for number, usages in self.history.numbers(envelope).items():
            last = usages[-1]
            where = whereabouts(last.live_at) or f"until {last.went}"
            taken[number] = f"{'is' if last.live_at else 'was'} {last.name!r} ({last.type}) {where}"
        return taken


@dataclass(frozen=True, slots=True)
class ChangedSetting:
    """Setting of a row that was published with another value, such as its direction."""

    before: dict[str, Setting]
    """The published settings by their texts; each text differs from that of today."""
    now: Setting | None
    """The setting today; None if the row does not have it any more."""

    @property
    def published(self) -> str:
        """The end of a diagnostic's message: the published texts, as in ``it was published with 'a' and with 'b'``."""
        return f"it was published with {' and with '.join(map(repr, self.before))}"

    def related(self) -> list[tuple[Span, str]]:
        """Return the places of the published settings, each with a text, for a diagnostic."""
        return [(setting.span, f"{text!r} was published here") for text, setting in self.before.items()]


@dataclass(frozen=True, slots=True)
class Context:
    """All data that the rules may look at: the table, the .proto files and the ledger of a state, and earlier states.

    The baseline is read in the same way as the state that is checked. So a rule finds in it what it would have reported
    there.
    """

    table: Table
    schema: Schema
    """The schema of the .proto files that compile; empty if no file compiles."""
    ledger: Ledger
    files: Mapping[str, File] = field(default_factory=dict)
    """The declarations in each .proto file by path, as far as the file can be read. Excluded files are left out."""
    excluded_files: Mapping[str, File] = field(default_factory=dict)
    """The declarations in each .proto file that the table excludes, by path."""
    shown_root: str = ""
    """The name of the folder of the .proto files in diagnostics: ``proto``, or ``main:proto`` in a baseline."""
    name: str = ""
    """The beginning of the file names in diagnostics, if the state is a baseline: ``main:protos``; else empty."""
    faults: tuple[Diagnostic, ...] = ()
    """Diagnostics about files of the state that could not be read completely, or that do not compile."""
    base: Context | None = None
    """The baseline: the earlier state that ``--against`` names; None without a baseline."""
    changes: tuple[SchemaChange, ...] = ()
    bounds: Bounds | None = None
    """The size limits of strings, arrays and other fields for nanopb; None if they were not read."""
    checkout: Schema | None = None
    """The schema with the declarations of the files that do not compile, too (see `with_uncompiled`)."""
    past: Past | None = None
    """The history of the .proto files in git; None if the user requested no check of the history."""
    tree: str = ""
    """The folder of .proto files as a command line names it; empty for a project with a table."""

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The payloads in the ledger, the table and the envelope of the state."""
        rows = self.table.rows if self.table.proto.root else ()  # the rows of a tree are the envelope's members
        settings = self.table.envelope
        envelope = self.schema.messages.get(settings.message)
        members = [field for field in envelope.fields if field.oneof == settings.oneof] if envelope else []
        return (
            *self.ledger.entries,
            *(Entry(row.number, row.name, row.proto, row.topic, False, False, row.at("number")) for row in rows),
            *(Entry(field.number, field.name, field.wire_type, "", False, False, field.span) for field in members),
        )

    @property
    def published(self) -> tuple[Entry, ...]:
        """All payloads that were published, according to the ledger (mapping.lock) and the baseline (``--against``)."""
        return (*self.ledger.entries, *(self.base.entries if self.base else ()))

    @property
    def read_files(self) -> ReadFiles:
        """The .proto files of the state, as protoc and the tolerant parser read them."""
        return ReadFiles(self.schema, self.files, self.shown_root)

    @property
    def published_settings(self) -> Iterator[RowSettings]:
        """The settings of the rows that were published, according to the ledger and the baseline."""
        yield self.ledger.settings
        if self.base is not None:
            if self.base.table.proto.root:
                yield settings_of_rows(self.base.table)
            yield self.base.ledger.settings

    def compared_with(self, base: Context) -> Context:
        """Return the context of a comparison with a baseline.

        A comparison of the baseline with itself shows what is no fault of the change.
        """
        change = SchemaChange(*read_alike(base.read_files, self.read_files), bounds_before=base.bounds)
        return replace(self, base=base, changes=(change, *self.changes))

    def changed_settings(self, row: Row) -> dict[str, ChangedSetting]:
        """Return the settings of a row that were published with another value, by key.

        Settings that the row did not have before are left out. The result is empty for a table with mistakes, in which
        a setting may be missing because it could not be read, and for a member of an envelope without a table.
        """
        if not self.table.whole or not row.direction:
            return {}
        now = settings_of_row(row, self.table)
        changed: dict[str, ChangedSetting] = {}
        for published in self.published_settings:
            for key, setting in published.get((row.number, row.proto), {}).items():
                today = now.get(key)
                if today is None or today.text != setting.text:
                    before = changed.setdefault(key, ChangedSetting({}, today)).before
                    before.setdefault(setting.text, setting)
        return changed

    def diagnostic_of_change(
        self, rule: type[Rule], row: Row, change: ChangedSetting, message: str, help: str, span: Span, rests_on: Span
    ) -> Diagnostic:
        """Return the diagnostic of a rule about a changed setting of a row, with the places of the published settings.

        It is dropped as a consequence if another diagnostic stands at the row's number, at its message or at
        ``rests_on``.
        """
        places = [row.at("number"), row.at("proto"), rests_on]
        envelope = self.table.envelope.message
        return rule.at(span, message, help, change.related(), type=envelope, number=row.number, rests_on=places)

    def changed_topics(self) -> Iterator[tuple[Row, str, ChangedSetting | None, ChangedSetting | None]]:
        """Yield each topic of each row, with the published type and the published QoS if they differ from today's.

        A topic that the row does not have any more is left out.
        """
        for row in self.table.rows:
            changed = self.changed_settings(row)
            for topic, type_key, qos_key in topics_of(row):
                yield row, topic.topic, changed.get(type_key), changed.get(qos_key)

    def next_number(self) -> int:
        """Return the envelope number for the next payload: the smallest free number above all used and published ones.

        If no larger number is free, this is the smallest free number. If no number at all is free, the result is larger
        than protobuf allows.
        """
        above = self.free_number(self.largest_number() + 1)
        return above if above <= LARGEST_FIELD_NUMBER else self.free_number(1)

    def free_number(self, number: int, besides: Set[int] = frozenset()) -> int:
        """Return the smallest free number of the envelope that is not less than ``number``.

        Numbers in ``besides`` count as free.
        """
        for _, last, _ in self.occupied(number, besides):
            number = last + 1
        return number

    def occupied(self, number: int, besides: Set[int] = frozenset()) -> Iterator[tuple[int, int, str]]:
        """Yield the occupied numbers of the envelope from ``number`` on, until a number is free.

        Each item is the first and the last number of a range, and the reason why the range is occupied:
        ``(8, 12, "is reserved in envelope.proto")``. Numbers in ``besides`` count as free.
        """
        taken, closed = self.taken(), list(self._closed())
        while True:
            found = [(last, why) for first, last, why in closed if first <= number <= last]
            if number in taken and number not in besides:
                found = [(number, taken[number])]
            if not found:
                return
            yield number, *found[0]
            number = found[0][0] + 1

    def largest_number(self) -> int:
        """Return the largest envelope number in the table and among all published payloads; 0 if there is none."""
        return max([0, *self.table.numbers, *(entry.number for entry in self.published)])

    def taken(self) -> dict[int, str]:
        """Return each number of the envelope that is used or must not be used again, with the reason as text.

        Ranges of reserved numbers are not included.
        """
        # From the weakest reason to the strongest: a later one replaces an earlier one for the same number.
        table, envelope = self.table, self.table.envelope.message
        taken: dict[int, str] = {}
        for path, message in self.declared(envelope):
            taken |= {field.number: f"is {field.name!r} in {path}" for field in message.fields}
        for claim, span in self.envelope_claims():
            taken[claim.number] = f"is the number of the commented-out field {claim.name!r} ({span})"
        if self.past is not None:
            taken |= self.past.taken(envelope)
        for number, burned in self.ledger.burned_in(envelope).items():
            taken[number] = f"was used for {burned.description}, and must never be used again"
        taken |= {entry.number: f"was published for {entry.name!r} ({entry.proto})" for entry in self.published}
        taken |= dict.fromkeys(table.numbers, f"is used in {table.file}")
        taken |= {row.number: f"is retired: it was {row.name!r} ({row.proto})" for row in table.retired}
        return taken | {row.number: f"is {row.name!r} ({row.proto})" for row in table.numbered}

    def _closed(self) -> Iterator[tuple[int, int, str]]:
        """Yield ranges of numbers that the envelope must not use: first number, last number, and the reason."""
        yield IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1, "is reserved for protobuf itself"
        for path, message in self.declared(self.table.envelope.message):
            for first, last in message.reserved:
                yield first, last, f"is reserved in {path}"
            for first, last in message.extension_ranges:
                yield first, last, f"is for extensions in {path}"

    def place(self, file: str, line: int, column: int) -> Span:
        """Return a place in a .proto file, as diagnostics show it; ``file`` is relative to the .proto folder."""
        return Span(shown(self.table.proto.root, file), line, column)

    def envelope_claims(self) -> Iterator[tuple[ProtoField, Span]]:
        """Yield each field of the envelope that is commented out in a .proto file, with its place."""
        for path, message in self.declared(self.table.envelope.message):
            for claim in message.claims:
                yield claim, self.place(path, claim.span.line, claim.span.column)

    def declared(self, full_name: str) -> Iterator[tuple[str, ProtoMessage]]:
        """Yield each declaration of the message ``full_name``, with the path of its file.

        By mistake, several files may declare the same message.
        """
        for path, file in self.files.items():
            for message in file.messages:
                if message.full_name == full_name:
                    yield path, message
