"""The context: all data that the rules may look at, such as the table, the protos, and earlier states."""

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
    """Return the change between the ledger's schema and a schema, in a tuple; empty if the ledger has no entries.

    ``incomplete`` names a message that `schema` does not contain in its final form. This message is not compared.
    """
    if not published.entries:
        return ()
    before = published.schema
    known = {name: message for name, message in before.messages.items() if name != incomplete}
    return (SchemaChange(replace(before, messages=known), schema, of_ledger=True),)


@dataclass(frozen=True, slots=True)
class Past:
    """The history of the protos in git, and the checks of it that the user requested."""

    history: History
    of_numbers: bool = False
    """True if the user requested the check of every number's history (``--history``)."""
    of_branches: bool = False
    """True if the user requested the comparison of open branches (``--branches``)."""
    pinned: tuple[Pinned, ...] = ()
    """For each project that uses the protos: the numbers of the envelope at the commit which that project uses."""

    def taken(self, envelope: str) -> dict[int, str]:
        """Return every number that the envelope ever had on any branch, with a text that says who has or had it."""
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
    """All data that the rules may look at: the table, the current protos, the ledger, and earlier states."""

    table: Table
    schema: Schema | None
    """The schema of the .proto files that compile; None if no file compiles."""
    ledger: Ledger
    files: Mapping[str, File] = field(default_factory=dict)
    """The declarations in each .proto file by path, as far as the file can be read. Excluded files are left out."""
    excluded_files: Mapping[str, File] = field(default_factory=dict)
    """The declarations in each .proto file that the table excludes, by path."""
    changes: tuple[SchemaChange, ...] = ()
    earlier_entries: tuple[Entry, ...] = ()
    """The payloads of the baseline; empty without a baseline."""
    bounds: Bounds | None = None
    """The size limits of nanopb; None if they were not read."""
    past: Past | None = None
    """The history in git; None if the user requested no check of it."""

    @property
    def published(self) -> tuple[Entry, ...]:
        """All payloads that were published, according to the ledger and the baseline."""
        return (*self.ledger.entries, *self.earlier_entries)

    def next_number(self) -> int:
        """Return the envelope number for the next payload: the smallest free number above all used and published ones.

        If no larger number is free, this is the smallest free number. If no number at all is free, the result is larger
        than protobuf allows.
        """
        above = self.free_number(self.largest_number() + 1)
        return above if above <= LARGEST_NUMBER else self.free_number(1)

    def free_number(self, number: int, besides: Set[int] = frozenset()) -> int:
        """Return the smallest free number of the envelope that is not less than ``number``.

        Numbers in ``besides`` count as free.
        """
        for _, last, _ in self.occupied(number, besides):
            number = last + 1
        return number

    def occupied(self, number: int, besides: Set[int] = frozenset()) -> Iterator[tuple[int, int, str]]:
        """Yield the occupied numbers of the envelope from ``number`` on, until a number is free.

        Each item is a range with both ends included, and the reason why it is occupied. Numbers in ``besides`` count as
        free.
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
        """Return every single number of the envelope that is used or must not be reused, with the reason."""
        # From the weakest reason to the strongest: a later one replaces an earlier one for the same number.
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
        """Yield ranges of numbers that the envelope must not use, each with the reason. Both ends are included."""
        yield IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1, "is reserved for protobuf itself"
        for path, message in self.declared(self.table.envelope.message):
            for first, last in message.reserved:
                yield first, last, f"is reserved in {path}"
            for first, last in message.extension_ranges:
                yield first, last, f"is for extensions in {path}"

    def place(self, file: str, line: int, column: int) -> Span:
        """Return a place in a .proto file; ``file`` is relative to the folder of the protos."""
        return Span(shown(self.table.proto.root, file), line, column)

    def envelope_claims(self) -> Iterator[tuple[ProtoField, Span]]:
        """Yield each member of the envelope that stands in a comment, with its place."""
        for path, message in self.declared(self.table.envelope.message):
            for claim in message.claims:
                yield claim, self.place(path, claim.span.line, claim.span.column)

    def declared(self, full_name: str) -> Iterator[tuple[str, ProtoMessage]]:
        """Yield each declaration of a message with the path of its file. A message may be declared in several files."""
        for path, file in self.files.items():
            for message in file.messages:
                if message.full_name == full_name:
                    yield path, message
