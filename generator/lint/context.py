"""The context of the rules: the table, the protos, and their past."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, field, replace

from roverlink.generator.diagnostics import Span, shown
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.history import History, branch_name
from roverlink.generator.lint.pinned_numbers import Pinned
from roverlink.generator.lock import Entry, Ledger
from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.parser import File
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import IMPLEMENTATION_NUMBERS, LARGEST_NUMBER, Table


def since_last_generate(published: Ledger, schema: Schema, incomplete: str = "") -> tuple[SchemaChange, ...]:
    """Return the change of the wire schema since the last generate; none if there is no ledger yet.

    ``incomplete`` names a message that `schema` does not contain in its final form, and that is not compared.
    """
    if not published.entries:
        return ()
    before = published.schema
    known = {name: message for name, message in before.messages.items() if name != incomplete}
    return (SchemaChange(replace(before, messages=known), schema, of_ledger=True),)


@dataclass(frozen=True, slots=True)
class Past:
    """The history of the protos, and the requested checks of it."""

    history: History
    of_numbers: bool = False
    """True if the history of every number is checked."""
    of_branches: bool = False
    """True if open branches are compared with each other."""
    pinned: tuple[Pinned, ...] = ()
    """The consumers, with the envelope's numbers at their pinned commits."""

    def taken(self, envelope: str) -> dict[int, str]:
        """Return every number that the envelope ever had on any branch, with the reason why it is taken."""
        taken: dict[int, str] = {}
        for number, usages in self.history.claims(envelope).items():
            taken[number] = f"was named in a comment for {usages[-1].name!r} ({usages[-1].came})"
        for number, usages in self.history.numbers(envelope).items():
            last = usages[-1]
            where = f" on {branch_name(last.live_at[0])}" if last.live_at else f" until {last.went}"
            taken[number] = f"{'is' if last.live_at else 'was'} {last.name!r} ({last.type}){where}"
        return taken


@dataclass(frozen=True, slots=True)
class Context:
    """The input of every rule: the table, the current protos, and their past."""

    table: Table
    schema: Schema | None
    """The compiled protos; None if nothing compiled."""
    ledger: Ledger
    files: Mapping[str, File] = field(default_factory=dict)
    """The declarations in each .proto file, as far as they can be read, without excluded files."""
    excluded_files: Mapping[str, File] = field(default_factory=dict)
    """The same for excluded files."""
    changes: tuple[SchemaChange, ...] = ()
    earlier_entries: tuple[Entry, ...] = ()
    """The payloads of the baseline."""
    bounds: Bounds | None = None
    """nanopb's bounds; None if they were not read."""
    past: Past | None = None
    """The history; None if it was not requested."""

    @property
    def published(self) -> tuple[Entry, ...]:
        """All payloads that are known to have been published."""
        return (*self.ledger.entries, *self.earlier_entries)

    def next_number(self) -> int:
        """Return the number for the next payload: the smallest free one above all published numbers.

        If no number above is free, this is the smallest free number. If none is free at all, it is larger than protobuf
        allows.
        """
        above = self.free_number(self.largest_number() + 1)
        return above if above <= LARGEST_NUMBER else self.free_number(1)

    def free_number(self, number: int, besides: Set[int] = frozenset()) -> int:
        """Return the smallest free number of the envelope from ``number`` on; numbers in ``besides`` count as free."""
        for _, last, _ in self.occupied(number, besides):
            number = last + 1
        return number

    def occupied(self, number: int, besides: Set[int] = frozenset()) -> Iterator[tuple[int, int, str]]:
        """Yield the occupied numbers from ``number`` on, up to the first free one.

        They are ranges with both ends included, each with its reason. Numbers in ``besides`` count as free.
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
        """Return the largest number of the table and of all published payloads; 0 for none."""
        return max([0, *self.table.numbers, *(entry.number for entry in self.published)])

    def taken(self) -> dict[int, str]:
        """Return every number of the envelope that is taken, with the reason."""
        table, envelope = self.table, self.table.envelope.message
        taken: dict[int, str] = {}
        for path, message in self.declared(envelope):
            taken |= {field.number: f"is {field.name!r} in {path}" for field in message.fields}
        for claim, span in self.envelope_claims():
            taken[claim.number] = f"is named in a comment for {claim.name!r} ({span})"
        if self.past is not None:
            taken |= self.past.taken(envelope)
        for number, burned in self.ledger.burned_in(envelope).items():
            taken[number] = (
                f"was used for {' and '.join(repr(type) for type, _ in burned.uses)}, and must never be used again"
            )
        taken |= {entry.number: f"was published for {entry.name!r} ({entry.proto})" for entry in self.published}
        taken |= dict.fromkeys(table.numbers, f"is used in {table.file}")
        taken |= {row.number: f"is retired: it was {row.name!r} ({row.proto})" for row in table.retired}
        return taken | {row.number: f"is {row.name!r} ({row.proto})" for row in table.rows}

    def _closed(self) -> Iterator[tuple[int, int, str]]:
        """Yield ranges of numbers that the envelope must not use, with the reason. Both ends are included."""
        yield IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1, "is reserved for protobuf itself"
        for path, message in self.declared(self.table.envelope.message):
            for first, last in message.reserved:
                yield first, last, f"is reserved in {path}"
            for first, last in message.extension_ranges:
                yield first, last, f"is for extensions in {path}"

    def place(self, file: str, line: int, column: int) -> Span:
        """Return a place in a .proto file."""
        return Span(shown(self.table.proto.root, file), line, column)

    def envelope_claims(self) -> Iterator[tuple[ProtoField, Span]]:
        """Yield members of the envelope that are commented out, with their places."""
        for path, message in self.declared(self.table.envelope.message):
            for claim in message.claims:
                yield claim, self.place(path, claim.span.line, claim.span.column)

    def declared(self, full_name: str) -> Iterator[tuple[str, ProtoMessage]]:
        """Yield the declarations of a message with their files; several if it is declared twice."""
        for path, file in self.files.items():
            for message in file.messages:
                if message.full_name == full_name:
                    yield path, message
