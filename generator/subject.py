"""What the rules look at."""

from __future__ import annotations

from dataclasses import dataclass

from generator.ledger import Ledger
from generator.protos import Schema
from generator.table import Table


@dataclass(frozen=True, slots=True)
class Subject:
    """The table, what protoc made of its protos (None where they did not compile), and the ledger."""

    table: Table
    schema: Schema | None
    ledger: Ledger

    def next_number(self) -> int:
        """The smallest number above every one that was ever used."""
        return max([0, *self.table.numbers, *(entry.number for entry in self.ledger.entries)]) + 1
