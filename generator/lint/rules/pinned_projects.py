"""Rule about projects that are pinned to commits in which a number has another meaning."""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass, field

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.misreadings import Misreading
from roverlink.generator.lint.pinned_states import Consumer, PinnedStates, ProtoState
from roverlink.generator.lint.rules import LintRule


@dataclass(frozen=True, slots=True)
class _Side:
    """All states of the protos that have one of two declarations, each with the place of the declaration."""

    text: str
    states: dict[int, tuple[ProtoState, Span]] = field(default_factory=dict)

    @property
    def consumers(self) -> list[Consumer]:
        return [consumer for state, _ in self.states.values() for consumer in state.consumers]

    @property
    def checkout(self) -> tuple[str, Span] | None:
        """Name of the checkout and the declaration's place in it, if the checkout has this declaration."""
        return next(((state.checkout, span) for state, span in self.states.values() if state.checkout), None)

    @property
    def names(self) -> str:
        checkout = [self.checkout[0]] if self.checkout else []
        return _listed([*checkout, *_quoted(self.consumers)])


class PinsDisagree(LintRule, id="PIN102"):
    """Two projects, or a project and this checkout, use protos that give one number to different things.

    The rover, the boards and the basestation each build the protos from the commit to which the project is pinned. If
    these commits disagree about the number of a payload, a field or an enum value, the receiver decodes the wrong thing
    without an error. All messages that the envelope can contain are compared. If a new name perhaps means the same,
    this is a warning. With `--against`, what the baseline has already is a hint, and so are faults of other projects.

    Bad::

        rover        4f1c2ab   # ArmBoardDiagnostics: float voltage = 1
        basestation  9d03e77   # ArmBoardDiagnostics: float temperature = 1

    Good::

        rover        9d03e77
        basestation  9d03e77
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each two declarations of a number that two projects, or one and the checkout, misread.

        States with the same declaration are named together. With a baseline, only what the checkout misreads, and the
        baseline in its place does not, is more than a hint.
        """
        past = context.past
        if past is None or past.pinned is None:
            return
        before = past.pinned_before
        known = {None, *(_of_checkout(*group) for group in _grouped(before))} if before else frozenset[Hashable]()
        for group in _grouped(past.pinned):
            finding = _finding(*group)
            yield finding.as_known() if _of_checkout(*group) in known else finding


def _of_checkout(found: Misreading, old: _Side, new: _Side) -> Hashable:
    """Return what stays the same of a misreading between the checkout and projects; None for one among projects."""
    if not (old.checkout or new.checkout):
        return None
    return found.owner, found.number, frozenset((old.text, new.text))


def _grouped(pinned: PinnedStates) -> Iterator[tuple[Misreading, _Side, _Side]]:
    """Yield each pair of declarations that are misread, with all states that have the one or the other."""
    groups: dict[tuple[str, int | None, str, str], tuple[Misreading, _Side, _Side]] = {}
    for indices, found in pinned.misreadings.items():
        for misreading in found:
            key = misreading.owner, misreading.number, misreading.old.text, misreading.new.text
            group = groups.setdefault(key, (misreading, _Side(misreading.old.text), _Side(misreading.new.text)))
            for side, index, span in zip(group[1:], indices, (misreading.old.span, misreading.new.span), strict=True):
                side.states[index] = pinned.states[index], span
    yield from groups.values()


def _finding(found: Misreading, old: _Side, new: _Side) -> Diagnostic:
    what = f"number {found.number} of {found.owner!r}" if found.number is not None else repr(found.owner)
    reason = f": {found.reason}" if found.reason else ""
    message = f"{what} is {old.text} in {old.names}, but {new.text} in {new.names}{reason}"
    checkout = old.checkout or new.checkout
    span = checkout[1] if checkout else new.consumers[-1].pin.span
    also = [*_places(old), *_places(new), *_pins([*old.consumers, *new.consumers])]
    also = [(place, text) for place, text in also if place != span]
    finding = PinsDisagree.at(span, message, _help(old, new), also, type=found.owner, number=found.number)
    if found.certain:
        return finding
    help = f"check if both mean the same; if not, {finding.help}"
    return dataclasses.replace(finding, help=help, severity=Severity.WARNING)


def _places(side: _Side) -> Iterator[tuple[Span, str]]:
    """Yield the place of the declaration at the first commit that has it."""
    for state, span in list(side.states.values())[:1]:
        if state.consumers:
            yield span, f"{side.text} at {state.consumers[0].commit}"


def _pins(consumers: Iterable[Consumer]) -> Iterator[tuple[Span, str]]:
    """Yield the place of a pin to each commit, with the names of all projects that are pinned to the commit."""
    of_commit: dict[str, list[Consumer]] = {}
    for consumer in consumers:
        of_commit.setdefault(consumer.commit.id, []).append(consumer)
    for first, *others in of_commit.values():
        names = _quoted([first, *others])
        yield first.pin.span, f"{_listed(names)} {'are' if len(names) > 1 else 'is'} pinned to {first.commit}"


def _help(old: _Side, new: _Side) -> str:
    """Return the text that tells what to do: the two programs must be built from the same declaration."""
    if new.checkout:
        help = f"build the other projects from {new.checkout[0]} before they exchange messages with it"
        is_declared = old.text.startswith("`")
        back = f"put back {old.text} and give the new declaration a number of its own"
        return f"{help}, or {back}" if is_declared else help
    if old.checkout:
        return f"update {old.checkout[0]}, or build the other projects from it"
    return "pin these projects to one commit, and build them from it"


def _quoted(consumers: Iterable[Consumer]) -> list[str]:
    return list(dict.fromkeys(repr(consumer.name) for consumer in consumers))


def _listed(names: list[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
