"""Diagnostics about numbers that had several meanings in git's history.

A diagnostic shows where the number is declared today, and which commits gave it its meanings.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence, Set
from itertools import groupby

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span, Use
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Confidence, History, Kind, Relation, Reuse, TracedType, Usage, branch_name
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, ProtoField, ProtoMessage

_RELATIONS = {
    Relation.SUCCESSION: "one after the other on one branch",
    Relation.BRANCHES: "on different branches",
    Relation.TOGETHER: "in the same commit",
}
_CONFIDENCES = {
    Confidence.CERTAIN: "",
    Confidence.LIKELY: "; this is not certain: some of the old files have syntax errors, or a type is not declared",
    Confidence.DOUBTFUL: "; this is doubtful: all old files with one of these meanings have syntax errors",
}


def reuses_by_number(context: Context, kinds: Set[Kind]) -> Iterator[tuple[TracedType, int, list[Reuse]]]:
    """Yield each number that had several meanings in git's history, with its changes of meaning.

    Each item has the message or enum, the number, and the changes. Only changes of the given kinds count. Numbers whose
    meanings the user has accepted with ``--accept`` are left out.
    """
    past = context.past
    if past is None or not past.of_numbers:
        return
    for type in past.history.types:
        accepted = [context.ledger.burned_in(name) for name in type.names]
        found = [reuse for reuse in past.history.reuses_of(type.id) if reuse.kind in kinds]
        for number, group in groupby(sorted(found, key=lambda reuse: reuse.number), key=lambda reuse: reuse.number):
            reuses = list(group)
            known = {use for burned in accepted if number in burned for use in burned[number].uses}
            uses = {(usage.type, usage.name) for reuse in reuses for usage in (reuse.earlier, reuse.later)}
            if not uses <= known:
                yield type, number, reuses


def _usages(history: History, owner: TracedType, number: int, reuses: Sequence[Reuse]) -> list[Usage]:
    """Return the usages of a number (its meanings) that the given reuses are about, the earliest first."""
    concerned = {usage for reuse in reuses for usage in (reuse.earlier, reuse.later)}
    return [usage for usage in history.numbers_of(owner.id)[number] if usage in concerned]


def reported(rule: Rule, context: Context, type: TracedType, number: int, reuses: Sequence[Reuse]) -> Diagnostic:
    """Return the diagnostic about one number that had several meanings in history.

    It is a hint if the baseline's history has all these meanings already, or if only an unmerged branch gave the number
    a second meaning (see `Reuse.unmerged`). The context must contain the history.
    """
    assert context.past is not None, "the rules of history check this first"  # noqa: S101  # for mypy
    owner, usages = type.name, _usages(context.past.history, type, number, reuses)
    finding = rule.at(
        place_of(context, owner, number),
        f"number {number} of {owner!r} was {_told(usages, reuses)}; {_today(context, owner, number)}"
        f"{_CONFIDENCES[max(reuse.confidence for reuse in reuses)]}",
        _help(context, owner, number),
        [(place_in_history(context, usage), _usage(usage)) for usage in usages],
        type=owner,
        number=number,
        uses=[Use(usage.type, usage.name, usage.came, usage.went) for usage in usages],
    )
    # With --against, what matters is the change since the baseline. A tree without a table has no ledger into which
    # earlier cases could be accepted, so that without this every change would fail because of them.
    # And what only an unmerged branch has done is the business of that branch, where it is an error.
    if all(reuse.unmerged or _began(reuse) <= context.past.before for reuse in reuses):
        return dataclasses.replace(finding, severity=Severity.HINT)
    return finding


def place_in_history(context: Context, usage: Usage) -> Span:
    """Return the place at which a usage was first declared: in a file of a commit, or in a file of today."""
    if usage.came.id:
        return Span(f"{usage.came.id[:10]}:{usage.path}", usage.line)
    return context.place(usage.path, usage.line, 0)


def _began(reuse: Reuse) -> set[str]:
    """Return the ids of the commits without which the number would not have both meanings."""
    # A message that kept its name has one usage, and got its new content later.
    return {
        reuse.earlier.came.id,
        reuse.new.commit.id if reuse.later is reuse.earlier and reuse.new else reuse.later.came.id,
    }


def _told(usages: Sequence[Usage], reuses: Sequence[Reuse]) -> str:
    """Return a text with the meanings of a number, and how they followed each other in time.

    An example is ``'gps' (Gps) and 'wind' (Wind), one after the other on one branch``.
    """
    last = reuses[-1]
    told = " and ".join(dict.fromkeys(_called(usage) for usage in usages))
    if len(usages) == 1:
        return f"{told}, and its content was replaced: {last.reason}"
    at_once = ", at the same time" if any(reuse.at_once for reuse in reuses) else ""
    reason = f" ({last.reason})" if last.reason else ""
    return f"{told}{reason}, {_RELATIONS[last.relation]}{at_once}"


def place_of(context: Context, owner: str, number: int) -> Span:
    """Return the place where a number of the message or enum ``owner`` is declared today.

    If no declaration has the number, this is the place of the message or enum. If the message or enum does not exist
    today, it is the place of the envelope.
    """
    declared = _declared(context, owner)
    if declared is None:
        return context.table.envelope.span
    part = _parts(context, declared).get(number)
    return part.at("number") if part else declared.span


def stands_today(context: Context, owner: str, number: int) -> tuple[str, str] | None:
    """Return type and name of the field or enum value that has a number today; None if no declaration has the number.

    The type of an enum value is empty.
    """
    declared = _declared(context, owner)
    part = _parts(context, declared).get(number) if declared else None
    return None if part is None else (part.wire_type if isinstance(part, ProtoField) else "", part.name)


def _declared(context: Context, owner: str) -> ProtoMessage | ProtoEnum | None:
    schema = context.schema
    return (schema.messages.get(owner) or schema.enums.get(owner)) if schema else None


def _parts(context: Context, declared: ProtoMessage | ProtoEnum) -> dict[int, ProtoField | ProtoEnumValue]:
    """Return the fields and extensions of a message, or the values of an enum, by number."""
    if isinstance(declared, ProtoMessage):
        extensions = context.schema.extensions if context.schema else ()
        added = [extension.field for extension in extensions if extension.extendee == declared.full_name]
        return {field.number: field for field in (*added, *declared.fields)}
    return {value.number: value for value in declared.values}


def _is_reserved(declared: ProtoMessage | ProtoEnum, number: int) -> bool:
    return any(first <= number <= last for first, last in declared.reserved)


def _today(context: Context, owner: str, number: int) -> str:
    declared = _declared(context, owner)
    if declared is None:
        return f"today {owner!r} does not exist"
    if part := _parts(context, declared).get(number):
        return f"today it is {part.name!r}"
    return "today it is reserved" if _is_reserved(declared, number) else "today it is free, and not reserved"


def _help(context: Context, owner: str, number: int) -> str:
    accept = (
        "`roverlink lint --history --accept` records this case in the ledger; later runs only report new cases"
        if context.table.proto.root
        else "with `--against REF`, cases that the branch or tag REF has already are only hints"
    )
    declared = _declared(context, owner)
    if declared is None or _is_reserved(declared, number):
        return accept
    if number in _parts(context, declared):
        return f"make sure that no board still uses the old meaning; {accept}"
    return f"write `reserved {number};` into {owner!r}; {accept}"


def _called(usage: Usage) -> str:
    return f"{usage.name!r} ({usage.type})" if usage.type else f"{usage.name!r}"


def _usage(usage: Usage) -> str:
    end = (
        f"and was removed with {usage.went}"
        if usage.went
        else f"and is now on {', '.join(branch_name(ref) for ref in usage.live_at[:3])}"
    )
    return f"{_called(usage)} was added with {usage.came}, {end}"
