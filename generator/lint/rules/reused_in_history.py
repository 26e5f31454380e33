"""Rules about numbers that had another meaning in git's history, or have one on another branch."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity, Use
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Allocation, Kind, whereabouts
from roverlink.generator.lint.history_diagnostics import number_never_used, place_of, reported, reuses_by_number
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.schema import Fact

_KINDS = frozenset({Kind.REUSED, Kind.RETYPED, Kind.MEANING})


class NumberReusedInHistory(LintRule, id="HIS101"):
    """A number had different meanings in the history of the repository.

    A comparison of two states cannot find this. One commit deleted the number, and a later commit or another branch
    gave it another meaning. Boards, basestations and rovers that were built from these commits misread each other
    without an error.

    Bad::

        message PBEnvelope { oneof payload { Foo foo = 18; } }   // in March
        message PBEnvelope { oneof payload { } }                 // in April
        message PBEnvelope { oneof payload { Bar bar = 18; } }   // in May

    Good::

        message PBEnvelope { oneof payload { Bar bar = 22; } reserved 18; reserved "foo"; }

    The past cannot be undone. If the number was only renamed, or if no machine confuses the meanings, the command in
    the help of the diagnostic accepts it, such as `roverlink lint --history --accept 18`. The meanings are then in the
    ledger: mapping.lock, or accepted-numbers.lock in a folder of .proto files without a table. A payload or field that
    has the number today keeps it, and the lint only reports further meanings. A number that is free is never used again
    (`roverlink explain ENV110`, `WIR111`, `WIR112`).
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number of a message or enum that had several meanings in history.

        Numbers that the user has accepted with ``--accept`` are left out.
        """
        for owner, number, reuses in reuses_by_number(context, _KINDS):
            yield reported(cls, context, owner, number, reuses)


class PayloadRenamed(LintRule, id="HIS102", severity=Severity.HINT):
    """A payload of the envelope was renamed in history, and its content stayed the same.

    Bytes do not carry names, so nothing is misread. But a search of the history for one name does not find the other.

    Bad::

        Imu imu = 13;       // until May
        ImuInfo imu = 13;   // since then, with the same fields

    Good::

        Imu imu = 13;
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number of the envelope whose payload was renamed.

        Numbers that another rule reports are left out.
        """
        worse = {(owner.id, number) for owner, number, _ in reuses_by_number(context, frozenset(Kind) - {Kind.RENAMED})}
        for owner, number, reuses in reuses_by_number(context, frozenset({Kind.RENAMED})):
            if owner.name == context.table.envelope.message and (owner.id, number) not in worse:
                yield reported(cls, context, owner, number, reuses)


class PayloadContentReplaced(LintRule, id="HIS103"):
    """The content of a payload was replaced in history, but its name stayed the same.

    The envelope looks unchanged, but the receiver reads the bytes of the old payload as fields of the new payload.

    Bad::

        message Status { float voltage = 1; float current = 2; float power = 3; }            // until May
        message Status { uint32 mode = 1; string text = 2; bool ready = 3; float age = 4; }  // since then

    Good::

        message StatusReport { uint32 mode = 1; string text = 2; bool ready = 3; float age = 4; }  // under a new number

    The past cannot be undone. The command in the help of the diagnostic accepts it (`roverlink explain HIS101`). If the
    content is replaced again later, the lint reports it again.
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number of the envelope whose payload kept its name, but not its fields."""
        for owner, number, reuses in reuses_by_number(context, frozenset({Kind.REPLACED})):
            yield reported(cls, context, owner, number, reuses)


class NumberGivenOnTwoBranches(LintRule, id="HIS104"):
    """Open branches have given the same number to different payloads, fields or enum values.

    The branch that is merged second takes the number from the first. Then the rover misreads boards with the firmware
    of the first branch. Before the merge, it is enough to change the number in one line. All messages that the envelope
    can contain are compared. If the two perhaps mean the same, this is a warning. With `--against`, a collision that
    your change has no part in is a hint.

    Bad::

        Wind wind = 22;     // on the branch wind-sensor
        Water water = 22;   // on the branch water-sensor

    Good::

        Wind wind = 22;     // on the branch wind-sensor
        Water water = 23;   // on the branch water-sensor
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number to which branches have given different payloads since they diverged."""
        past, envelope = context.past, context.table.envelope.message
        if past is None or not past.of_branches:
            return
        for collision in past.history.collisions(envelope):
            owner, number = collision.owner, collision.number
            message = f"number {number} of {owner!r} is {' and '.join(map(_allocation_text, collision.allocations))}"
            free = number_never_used(context, past.history, owner)
            other = f"the number {free}, which no branch uses" if free else "a number in another type"
            finding = cls.at(
                place_of(context, owner, number),
                message if collision.certain else f"{message}: {collision.reason}",
                f"keep the number for one of them, and give the other one {other}",
                type=owner,
                number=number,
                uses=[_use(context, number, allocation) for allocation in collision.allocations],
            )
            if past.is_known(*(allocation.came for allocation in collision.allocations), *collision.naming):
                yield finding.as_known()
            else:
                yield finding if collision.certain else dataclasses.replace(finding, severity=Severity.WARNING)


def _use(context: Context, number: int, allocation: Allocation) -> Use:
    declaration = Fact(number, allocation.name, allocation.type).text
    place = context.place(allocation.path, allocation.line, 0)
    return Use(
        allocation.type, allocation.name, allocation.came, None, (declaration,), place, whereabouts(allocation.refs)
    )


def _allocation_text(allocation: Allocation) -> str:
    called = f"{allocation.name!r} ({allocation.type})" if allocation.type else repr(allocation.name)
    return f"{called} {whereabouts(allocation.refs)}"


_CERTAIN = frozenset({Kind.REUSED, Kind.RETYPED, Kind.MEANING, Kind.REPLACED})


class NumberPerhapsReused(LintRule, id="HIS105", severity=Severity.WARNING):
    """A number may have had different meanings in the history of the repository, and the names do not show it.

    One commit gave the number another name, and the two names are similar, but not so similar that they certainly mean
    the same: `speed` and `velocity`, `lattitude` and `latitude`. Or the new name says another unit: `reach_mm` and
    `reach_m`. If the old name meant something else, boards and rovers that were built from these commits misread each
    other without an error. `roverlink explain WIR116` says which names are doubtful.

    Bad::

        message Motor { float speed = 1; }      // until May
        message Motor { float velocity = 1; }   // since then

    Good::

        message Motor { reserved 1; reserved "speed"; float velocity = 2; }

    If both names have the same meaning, the command in the help of the diagnostic accepts it, such as `roverlink lint
    --history --accept rover.Motor:1`. Then the lint only reports further meanings (`roverlink explain HIS101`).
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number that may have had several meanings in history.

        Numbers that another rule reports are left out.
        """
        worse = {(owner, number) for owner, number, _ in reuses_by_number(context, _CERTAIN)}
        for owner, number, reuses in reuses_by_number(context, frozenset({Kind.DOUBTFUL, Kind.UNIT})):
            if (owner, number) not in worse:
                yield reported(cls, context, owner, number, reuses)
