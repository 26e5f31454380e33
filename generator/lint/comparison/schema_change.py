"""A schema before and after."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.schema import Schema


@dataclass(frozen=True, slots=True)
class Change:
    """The protos as they were, and as they are."""

    before: Schema
    after: Schema
    of_ledger: bool = False
    """True if the earlier state is the ledger, which has only names, numbers and types of what can travel."""
    bounds_before: Bounds | None = None
    """nanopb's bounds as they were; None where they are not known."""
