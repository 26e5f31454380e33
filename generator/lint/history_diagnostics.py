"""Diagnostics about numbers that had several meanings in git's history.

A diagnostic says in one sentence how the number got another meaning. It shows the declarations beside each other, each
with the commits that added and removed it.
"""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Iterator, Sequence, Set
from itertools import groupby, zip_longest
from operator import itemgetter
from posixpath import normpath
from typing import TYPE_CHECKING

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span, Use
from roverlink.generator.git import Commit
from roverlink.generator.lint.accepted_past import command_to_accept, meaning_of, not_accepted
from roverlink.generator.lint.context import Context, Past
from roverlink.generator.lint.free_numbers import next_enum_number, next_field_number
from roverlink.generator.lint.history import Content, Kind, Relation, Reuse, TracedType, Usage, whereabouts
from roverlink.generator.lint.history.judged_facts import is_named
from roverlink.generator.lock import PastUse
from roverlink.generator.protos.number_ranges import covers
from roverlink.generator.protos.schema import Fact, ProtoEnum, ProtoEnumValue, ProtoField, ProtoMessage
from roverlink.numerals import counted

if TYPE_CHECKING:
    from roverlink.generator.lint.history import History

_MOST_CHANGES = 3


def reuses_by_number(context: Context, kinds: Set[Kind]) -> Iterator[tuple[TracedType, int, list[Reuse]]]:
    """Yield each number that had several meanings in git's history, with its changes of meaning.

    Each item has the message or enum, the number, and the changes. Only changes of the given kinds count. Those that
    the user has accepted with ``--accept`` are left out.
    """
    past = context.past
    if past is None or not past.of_numbers:
        return
    for type in past.history.types:
        found = [reuse for reuse in past.history.reuses_of(type.id) if reuse.kind in kinds]
        for number, group in groupby(sorted(found, key=lambda reuse: reuse.number), key=lambda reuse: reuse.number):
            if reuses := list(not_accepted(context, type, group)):
                yield type, number, reuses


def reported(rule: type[Rule], context: Context, type: TracedType, number: int, reuses: Sequence[Reuse]) -> Diagnostic:
    """Return the diagnostic about one number that had several meanings in history.

    It is a hint if no commit of the change gave the number one of these meanings, if only an unmerged branch gave it a
    second meaning (see `Reuse.unmerged`), or if no program was built with one of the meanings (see `Reuse.unbuilt`).
    The context must contain the history.
    """
    past = context.past
    assert past is not None, "the rules of history check this first"  # noqa: S101  # for mypy
    owner, order = type.name, past.history.numbers_of(type.id)[number]
    changes = _last_changes_text(_last_changes(order, reuses))
    finding = rule.at(
        place_of(context, owner, number),
        f"number {number} of {owner!r} {changes}{_today(context, owner, number)}",
        _help(context, past, owner, number, reuses),
        type=owner,
        number=number,
        uses=list(_uses(context, order, reuses)),
    )
    if all(past.is_known(*began(reuse)) for reuse in reuses):
        return finding.as_known()
    # What only an unmerged branch has done is the business of that branch, where it is an error.
    # No board has a meaning that stood only in a file that protoc rejects, as one with conflict markers.
    if all(reuse.unmerged or reuse.unbuilt or past.is_known(*began(reuse)) for reuse in reuses):
        return dataclasses.replace(finding, severity=Severity.HINT)
    return finding


def use_of(context: Context, usage: Usage, doubt: str = "") -> Use:
    """Return a usage (a meaning of a number) as a diagnostic shows it. ``doubt`` says why it is not certain."""
    return Use(
        usage.type,
        usage.name,
        usage.came,
        _ended(usage),
        (usage.fact.text,),
        _place(context, usage.path, usage.line),
        whereabouts(usage.live_at),
        doubt,
    )


def _ended(usage: Usage) -> Commit | None:
    """Return the commit that ended a usage; None if it has not ended."""
    # A change that is not committed yet has removed it: the branch still has it, but not for long.
    return next((commit for commit in usage.intervals[-1].went if not commit.id), usage.went)


def _uses(context: Context, order: Sequence[Usage], reuses: Sequence[Reuse]) -> Iterator[Use]:
    """Yield the usages (meanings) that the reuses of a number are about, in the given order.

    For a message that kept its name, these are its contents.
    """
    # By fact, which no other usage of the number has: comparing two of thousands of usages takes long.
    within, concerned = defaultdict[Fact, list[Reuse]](list), defaultdict[Fact, list[Reuse]](list)
    for reuse in reuses:
        if reuse.earlier is reuse.later:
            within[reuse.later.fact].append(reuse)
        else:
            concerned[reuse.earlier.fact].append(reuse)
            concerned[reuse.later.fact].append(reuse)
    for usage in order:
        for reuse in within[usage.fact]:
            yield from _contents(context, reuse)
        if about := concerned[usage.fact]:
            yield use_of(context, usage, next(filter(None, (_doubt(reuse, usage) for reuse in about)), ""))


def _doubt(reuse: Reuse, usage: Usage) -> str:
    """Return why the evidence of a reuse about one of its usages is not certain; empty if it is."""
    if usage.broken:
        return "it was only read from files with syntax errors"
    types = reuse.earlier.type, reuse.later.type
    # The contents of the types are evidence only if they were compared.
    if types[0] == types[1] or not all(map(is_named, types)):
        return ""
    content = reuse.old if usage is reuse.earlier else reuse.new
    if content is None or not content.there:
        return f"no file declares {usage.type!r} at this commit"
    return _doubt_of_content(content)


def _doubt_of_content(content: Content) -> str:
    return f"the file of {content.type!r} has syntax errors at this commit" if content.broken else ""


def _contents(context: Context, reuse: Reuse) -> Iterator[Use]:
    """Yield the two contents of a message that kept its name, each with the fields that differ."""
    old, new, usage = reuse.old, reuse.new, reuse.later
    assert old is not None, "a content was replaced"  # noqa: S101  # for mypy
    assert new is not None, "a content was replaced"  # noqa: S101  # for mypy
    lines = list(_differing_fields(old.facts, new.facts))
    for side, (content, last) in enumerate(((old, new.commit), (new, _ended(usage)))):
        declaration = (f"message {content.type.rpartition('.')[2]} {{", *(line[side] for line in lines), "}")
        yield Use(
            usage.type,
            usage.name,
            content.commit,
            last,
            declaration,
            _place(context, content.path, content.line),
            whereabouts(usage.live_at) if side else "",
            _doubt_of_content(content),
        )


def _differing_fields(old: Sequence[Fact], new: Sequence[Fact]) -> Iterator[tuple[str, str]]:
    """Yield the declarations of fields that only one of two contents has, side by side if they have one number."""
    for number in sorted({fact.number for fact in {*old} ^ {*new}}):
        sides = ([fact.text for fact in facts if fact.number == number] for facts in (old, new))
        yield from ((f"  {one}".rstrip(), f"  {other}".rstrip()) for one, other in zip_longest(*sides, fillvalue=""))


def _place(context: Context, path: str, line: int) -> Span:
    """Return a place in a file of history, which may have been outside of the folder of .proto files."""
    place = context.place(path, line, 0)
    return dataclasses.replace(place, file=normpath(place.file))


def _last_changes(order: Sequence[Usage], reuses: Sequence[Reuse]) -> list[Reuse]:
    """Return for each usage of a number how it differs from the latest usage before it.

    The others, such as the change from the first usage to the third one, would only repeat what these say.
    """
    position = {usage.fact: index for index, usage in enumerate(order)}
    last: dict[int, Reuse] = {}
    for reuse in sorted(reuses, key=lambda reuse: position[reuse.earlier.fact]):
        if reuse.earlier is not reuse.later:
            last[position[reuse.later.fact]] = reuse
    within = (reuse for reuse in reuses if reuse.earlier is reuse.later)
    return [*(reuse for _, reuse in sorted(last.items(), key=itemgetter(0))), *within]


def _last_changes_text(changes: Sequence[Reuse]) -> str:
    """Return how a number got its meanings, as a predicate: only the latest of many changes."""
    text = "; it ".join(map(_change_text, changes[-_MOST_CHANGES:]))
    more = len(changes) - _MOST_CHANGES
    return f"{text} (and {counted(more, 'change')} of meaning before)" if more > 0 else text


def began(reuse: Reuse) -> tuple[Commit, ...]:
    """Return the commits without which the number would not have both meanings."""
    # A message that kept its name has one usage, and got its new content later.
    within = reuse.later is reuse.earlier and reuse.new
    return reuse.earlier.came, reuse.new.commit if within and reuse.new else reuse.later.came, *reuse.naming


def _change_text(reuse: Reuse) -> str:
    """Return how a number got another meaning, with the reason why it is another one, as a predicate.

    An example is ``was given to 'wind' (Wind) after 'gps' (Gps) was removed: 'Wind' has 0 of the 2 fields of 'Gps'``.
    """
    earlier, later = _called(reuse.earlier), _called(reuse.later)
    if reuse.earlier is reuse.later:
        text = f"kept the name {earlier}, but the content of {reuse.later.type!r} was replaced"
    elif reuse.kind is Kind.RENAMED:
        text = f"was renamed from {earlier} to {later}"
    elif reuse.earlier.name == reuse.later.name and reuse.relation is Relation.SUCCESSION:
        text = f"was `{reuse.earlier.fact.text}` and became `{reuse.later.fact.text}`"
    elif reuse.relation is Relation.SUCCESSION:
        text = f"was given to {later} after {earlier} was removed"
    elif reuse.relation is Relation.TOGETHER:
        text = f"was given to {earlier} and {later} by one commit"
    elif reuse.earlier.live_at and reuse.later.live_at:
        places = [whereabouts(usage.live_at) for usage in (reuse.earlier, reuse.later)]
        text = f"is {earlier} {places[0]} and {later} {places[1]}"
    else:
        text = f"was given to {earlier} and {later} on different branches"
    return f"{text}: {reuse.reason}" if reuse.reason else text


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


def stands_today(context: Context, owner: str, number: int) -> PastUse | None:
    """Return the meaning that a number has today; None if no declaration has the number."""
    declared = _declared(context, owner)
    part = _parts(context, declared).get(number) if declared else None
    return meaning_of(part) if part else None


def _declared(context: Context, owner: str) -> ProtoMessage | ProtoEnum | None:
    schema = context.checkout or context.schema
    return schema.messages.get(owner) or schema.enums.get(owner)


def _parts(context: Context, declared: ProtoMessage | ProtoEnum) -> dict[int, ProtoField | ProtoEnumValue]:
    """Return the fields and extensions of a message, or the values of an enum, by number."""
    if isinstance(declared, ProtoMessage):
        extensions = context.checkout.extensions if context.checkout else ()
        added = [extension.field for extension in extensions if extension.extendee == declared.full_name]
        return {field.number: field for field in (*added, *declared.fields)}
    return {value.number: value for value in declared.values}


def _compiles(context: Context, declared: ProtoMessage | ProtoEnum) -> bool:
    """Return False if the file of a message or enum does not compile, so that a part of it may be unknown."""
    return context.checkout is None or declared.file not in context.checkout.uncompiled


def _today(context: Context, owner: str, number: int) -> str:
    """Return a clause about the number today if no declaration shows it."""
    declared = _declared(context, owner)
    if declared is None:
        return f"; today {owner!r} does not exist"
    if number in _parts(context, declared) or not _compiles(context, declared):
        return ""
    return "; today it is reserved" if covers(declared.reserved, number) else "; today it is free, and not reserved"


def number_never_used(context: Context, history: History, owner: str) -> int | None:
    """Return a number of a message or enum that no commit of any branch used; None if no number is left."""
    if owner == context.table.envelope.message:
        return context.next_number()
    taken = history.numbers(owner)
    if owner in history.enums:
        return next_enum_number(context, owner, taken)
    return next_field_number(context, owner, taken)


def _help(context: Context, past: Past, owner: str, number: int, reuses: Sequence[Reuse]) -> str:
    accept = f"if this was only a rename or is harmless, `{command_to_accept(context, owner, number)}` accepts it"
    if burned := context.ledger.burned_in(owner).get(number):
        accept = f"accepted so far: {burned.description}; {accept}"
    declared = _declared(context, owner)
    if declared and not _compiles(context, declared):
        return "correct the errors in this file, and run the lint again"
    if declared is None or covers(declared.reserved, number):
        return accept
    if part := _parts(context, declared).get(number):
        free = number_never_used(context, past.history, owner)
        # The meaning of today can still be changed if nobody else has it yet.
        if free and any(past.is_new(reuse.later.came) and reuse.later.name == part.name for reuse in reuses):
            return f"give {part.name!r} the number {free}, which was never used; {accept}"
        return f"make sure that no board still uses the old meaning; {accept}"
    return f"write `reserved {number};` into {owner!r}; {accept}"


def _called(usage: Usage) -> str:
    return f"{usage.name!r} ({usage.type})" if usage.type else f"{usage.name!r}"
