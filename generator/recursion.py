"""Messages that hold themselves: how often each may stand inside itself, and which ROS message it is at which level.

ROS has no such messages. Where a row says how deep its payload may be, each level is a ROS message of its own, and the
last lacks the fields that would lead further.

Messages that hold each other are numbered in the order in which the rows reach them. A field that leads to a later one
stays at its level; a field that leads to an earlier one, or to the message itself, goes to the next. Every circle has
such a field, so every circle ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from generator.conversion_rules import DISAGREEING_ROWS
from generator.diagnostics import Diagnostic
from generator.table import Row, Table

CUT = 0
"""The level of a message that is not there any more."""


class Levels:
    """The level of each message inside the others."""

    def __init__(
        self, table: Table, holds: Callable[[str], Iterable[str]], report: Callable[[Diagnostic], None]
    ) -> None:
        """``holds`` gives the messages that the fields of a message hold."""
        self._order: dict[str, int] = {}
        self._held: dict[str, tuple[str, ...]] = {}
        for row in sorted(table.rows, key=lambda row: row.number):
            self._explore(row.proto, holds)
        self._circle = {name: circle for circle in _circles(self._held) for name in circle}
        self._bounds: dict[frozenset[str], tuple[int, Row]] = {}
        self.rows_without_effect: list[Row] = []
        for row in table.rows:
            if row.recursion is not None and row.feed is None:
                self._bound(row, row.recursion, report)

    def _explore(self, root: str, holds: Callable[[str], Iterable[str]]) -> None:
        waiting = [root]
        while waiting:
            name = waiting.pop()
            if name not in self._held:
                self._order[name] = len(self._order)
                self._held[name] = tuple(dict.fromkeys(holds(name)))
                waiting += reversed(self._held[name])

    def _bound(self, row: Row, bound: int, report: Callable[[Diagnostic], None]) -> None:
        circles = {self._circle[name] for name in _reachable(row.proto, self._held) if name in self._circle}
        if not circles:
            self.rows_without_effect.append(row)
        for circle in circles:
            said, first = self._bounds.setdefault(circle, (bound, row))
            if said != bound:
                message = f"{min(circle)} may stand in itself {bound} times here, and {said} times in another row"
                also = [(first.at("recursion"), f"the row {first.name}")]
                report(DISAGREEING_ROWS.at(row.at("recursion"), message, "give both rows the same recursion", also))

    def _is_recursive(self, holder: str, held: str) -> bool:
        """Whether a field of a message leads back to that message."""
        return holder in self._circle and held in self._circle[holder]

    def of(self, holder: str, level: int, held: str) -> int:
        """The level of a message in another; `CUT` where it would be one too many."""
        if not self._is_recursive(holder, held):
            return 1
        next_level = level if self._order[held] > self._order[holder] else level + 1
        circle = self._circle[holder]
        if circle not in self._bounds:
            return 1  # the circle is found fault with when it closes
        return next_level if next_level <= self._bounds[circle][0] else CUT

    def is_carried(self, holder: str, held: str) -> bool:
        """Whether a field of a message leads back to that message, and a row says how often."""
        return self._is_recursive(holder, held) and self._circle[holder] in self._bounds


def _reachable(root: str, held: Mapping[str, Iterable[str]]) -> set[str]:
    seen: set[str] = set()
    waiting = [root]
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += held.get(name, ())
    return seen


def _circles(held: Mapping[str, Iterable[str]]) -> Iterator[frozenset[str]]:
    """The largest sets of messages that each hold all of them, themselves included."""
    reachable = {name: set().union(*(_reachable(one, held) for one in inside)) for name, inside in held.items()}
    told: set[str] = set()
    for name in held:
        if name in reachable[name] and name not in told:
            circle = frozenset(other for other in reachable[name] if name in reachable.get(other, ()))
            told |= circle
            yield circle
