"""Schemas of other projects, which pin commits of the .proto files: they explain the schema that a board tells."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.lint.misreadings import Misreading
from roverlink.generator.lint.pinned_states import PinnedStates
from roverlink.generator.lint.project import Question, lint_project
from roverlink.generator.protos.row_hash import row_hash


class OtherSchema(NamedTuple):
    """Another schema of a row, which a pinned project has."""

    text: str
    """Projects that have the schema, and what a program with it has to expect."""
    compatible: bool
    """True if each side reads what the other one sends."""


class PinnedSchemas:
    """Comparison of the schema of today with those of the commits that other projects pin."""

    def __init__(self, table: Path, pins: Sequence[Path]) -> None:
        """Read the commits that ``pins`` name: files and repositories, as for ``roverlink lint --pins``.

        Raises `DiagnosticsError` if a pin or a commit cannot be read.
        """
        found = lint_project(table, Question(pins=tuple(pins)))
        fatal = [finding for finding in found.findings if finding.severity is Severity.FATAL]
        past = found.context.past
        if fatal or past is None or past.pinned is None:
            raise DiagnosticsError(fatal)
        self._pinned: PinnedStates = past.pinned

    def compare(self, payload: str, hash: int) -> OtherSchema | None:
        """Return what a program with another schema of a row has to expect; None if no project has this schema.

        ``payload`` is the full name of the row's message, and ``hash`` the hash that the program has told.
        """
        states = self._pinned.states
        today = next(index for index, state in enumerate(states) if state.checkout)
        for index, state in enumerate(states):
            if index != today and payload in state.schema.messages and row_hash(state.schema, payload) == hash:
                who = ", ".join(f"{consumer.name!r} ({consumer.commit.id[:10]})" for consumer in state.consumers)
                misread = self._misread(payload, index, today)
                said = "; ".join(misread) or "compatible, each side reads what the other one sends"
                return OtherSchema(f"that of {who}: {said}", not misread)
        return None

    def _misread(self, payload: str, other: int, today: int) -> list[str]:
        older, newer = sorted((other, today))
        messages, enums = self._pinned.states[today].schema.reachable(payload)
        found = [
            misreading
            for misreading in self._pinned.misreadings[older, newer]
            if misreading.owner in {*messages, *enums}
        ]
        return [_told(misreading, there_is_older=other < today) for misreading in found]


def _told(misreading: Misreading, there_is_older: bool) -> str:
    there, here = (misreading.old, misreading.new) if there_is_older else (misreading.new, misreading.old)
    doubt = "" if misreading.certain else "perhaps "
    number = f"number {misreading.number} of {misreading.owner!r}"
    return f"{doubt}misread: {number} is {there.text} there, and {here.text} here"
