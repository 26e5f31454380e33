"""What the rules look at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from generator.declarations import Claim, File, Message
from generator.findings import Span, shown
from generator.ledger import Entry, Ledger
from generator.protos import Schema
from generator.table import Table

if TYPE_CHECKING:
    from generator.nanopb import Bounds


@dataclass(frozen=True, slots=True)
class Change:
    """The protos as they were, and as they are."""

    before: Schema
    after: Schema
    since: str
    """How findings call the earlier state: a git ref, a folder, a file, the ledger."""
    of_ledger: bool = False
    """Whether the earlier state is the ledger: names, numbers and types of what can travel, and nothing else."""
    bounds_before: Bounds | None = None
    """nanopb's bounds as they were; None where they are not known."""


@dataclass(frozen=True, slots=True)
class Subject:
    """The table, the protos as they are, and what is known of their past."""

    table: Table
    schema: Schema | None
    """None where the protos did not compile."""
    ledger: Ledger
    files: Mapping[str, File] = field(default_factory=dict)
    """What each .proto file below the root declares, as far as it can be read; the excluded ones are not among them."""
    excluded_files: Mapping[str, File] = field(default_factory=dict)
    """The same, of the files that the table leaves out."""
    changes: tuple[Change, ...] = ()
    earlier_entries: tuple[Entry, ...] = ()
    """The payloads of the state that this one is compared with."""
    bounds: Bounds | None = None
    """nanopb's bounds; None where they were not read."""

    @property
    def published(self) -> tuple[Entry, ...]:
        """Every number that is known to have been published."""
        return (*self.ledger.entries, *self.earlier_entries)

    def next_number(self) -> int:
        """The smallest number above every one that was ever used or claimed."""
        used = {0, *self.table.numbers, *(entry.number for entry in self.published)}
        used |= {claim.number for claim, _ in self.envelope_claims()}
        return max(used) + 1

    def place(self, file: str, line: int, column: int) -> Span:
        """A place in a .proto file."""
        return Span(shown(self.table.proto.root, file), line, column)

    def envelope_claims(self) -> Iterator[tuple[Claim, Span]]:
        """Members of the envelope that somebody commented out, with their places."""
        for path, message in self.declared(self.table.envelope.message):
            for claim in message.claims:
                yield claim, self.place(path, claim.line, claim.column)

    def declared(self, full_name: str) -> Iterator[tuple[str, Message]]:
        """The declarations of a message, each with its file; more than one where it is declared twice."""
        for path, file in self.files.items():
            for message in file.all_messages():
                if message.full_name == full_name:
                    yield path, message
