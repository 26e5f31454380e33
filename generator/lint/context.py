"""The context of the rules: the table, the protos, and what is known of their past."""

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
    """What became of the wire schema that the ledger has; nothing where there is no ledger yet.

    ``incomplete`` names a message that `schema` does not have as it will be, of which nothing can be said.
    """
    if not published.entries:
        return ()
    before = published.schema
    known = {name: message for name, message in before.messages.items() if name != incomplete}
    return (SchemaChange(replace(before, messages=known), schema, of_ledger=True),)


@dataclass(frozen=True, slots=True)
class Past:
    """The history of the protos, and what of it is looked at."""

    history: History
    of_numbers: bool = False
    """Whether every number's past is judged."""
    of_branches: bool = False
    """Whether open branches are compared with each other."""
    pinned: tuple[Pinned, ...] = ()
    """The consumers, and what the commits that they are pinned to say."""

    def taken(self, envelope: str) -> dict[int, str]:
        """Every number that the envelope ever had on any branch, and what for."""
        taken: dict[int, str] = {}
        for number, usages in self.history.claims(envelope).items():
            taken[number] = f"stood in a comment, for {usages[-1].name} ({usages[-1].came})"
        for number, usages in self.history.numbers(envelope).items():
            last = usages[-1]
            where = f", which {branch_name(last.live_at[0])} has" if last.live_at else f" until {last.went}"
            taken[number] = f"stood for {last.name} ({last.type}){where}"
        return taken


@dataclass(frozen=True, slots=True)
class Context:
    """The table, the protos as they are, and what is known of their past."""

    table: Table
    schema: Schema | None
    """None where the protos did not compile."""
    ledger: Ledger
    files: Mapping[str, File] = field(default_factory=dict)
    """What each .proto file below the root declares, as far as it can be read; the excluded ones are not among them."""
    excluded_files: Mapping[str, File] = field(default_factory=dict)
    """The same, of the files that the table leaves out."""
    changes: tuple[SchemaChange, ...] = ()
    earlier_entries: tuple[Entry, ...] = ()
    """The payloads of the state that this one is compared with."""
    bounds: Bounds | None = None
    """nanopb's bounds; None where they were not read."""
    past: Past | None = None
    """All of history; None where nobody asked for it."""

    @property
    def published(self) -> tuple[Entry, ...]:
        """Every number that is known to have been published."""
        return (*self.ledger.entries, *self.earlier_entries)

    def next_number(self) -> int:
        """The number for the next payload: the smallest above all published ones that nothing ever had or claimed.

        Where all of those are closed, it is the smallest of all; and one that is too large where none is left.
        """
        above = self.free_number(self.largest_number() + 1)
        return above if above <= LARGEST_NUMBER else self.free_number(1)

    def free_number(self, number: int, besides: Set[int] = frozenset()) -> int:
        """The smallest number of the envelope, from one on, that is free but for what ``besides`` has."""
        for _, last, _ in self.occupied(number, besides):
            number = last + 1
        return number

    def occupied(self, number: int, besides: Set[int] = frozenset()) -> Iterator[tuple[int, int, str]]:
        """The numbers of the envelope from one on that cannot be given to a new payload, up to the first that can.

        They come as ranges, both ends included, each with its reason; those that ``besides`` has count as free.
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
        """The largest number of the table, or that is known to have been published; 0 for none."""
        return max([0, *self.table.numbers, *(entry.number for entry in self.published)])

    def taken(self) -> dict[int, str]:
        """Every single number of the envelope that cannot be given to a new payload, and why."""
        table, envelope = self.table, self.table.envelope.message
        taken: dict[int, str] = {}
        for path, message in self.declared(envelope):
            taken |= {field.number: f"is that of {field.name} in {path}" for field in message.fields}
        for claim, span in self.envelope_claims():
            taken[claim.number] = f"stands in a comment, for {claim.name} ({span})"
        if self.past is not None:
            taken |= self.past.taken(envelope)
        for number, burned in self.ledger.burned_in(envelope).items():
            taken[number] = f"stood for {' and for '.join(type for type, _ in burned.uses)}"
        taken |= {entry.number: f"was published for {entry.name} ({entry.proto})" for entry in self.published}
        taken |= dict.fromkeys(table.numbers, f"stands in {table.file}")
        taken |= {row.number: f"is retired, of {row.name} ({row.proto})" for row in table.retired}
        return taken | {row.number: f"is that of {row.name} ({row.proto})" for row in table.rows}

    def _closed(self) -> Iterator[tuple[int, int, str]]:
        """Ranges of numbers that the envelope keeps closed, both ends included, and why."""
        yield IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1, "is kept by protobuf for itself"
        for path, message in self.declared(self.table.envelope.message):
            for first, last in message.reserved:
                yield first, last, f"is reserved in {path}"
            for first, last in message.extension_ranges:
                yield first, last, f"is for extensions in {path}"

    def place(self, file: str, line: int, column: int) -> Span:
        """A place in a .proto file."""
        return Span(shown(self.table.proto.root, file), line, column)

    def envelope_claims(self) -> Iterator[tuple[ProtoField, Span]]:
        """Members of the envelope that somebody commented out, with their places."""
        for path, message in self.declared(self.table.envelope.message):
            for claim in message.claims:
                yield claim, self.place(path, claim.span.line, claim.span.column)

    def declared(self, full_name: str) -> Iterator[tuple[str, ProtoMessage]]:
        """The declarations of a message, each with its file; more than one where it is declared twice."""
        for path, file in self.files.items():
            for message in file.messages:
                if message.full_name == full_name:
                    yield path, message
