"""Numbers whose past the user has accepted: the lint reports only the meanings that such a number got later."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeAlias

from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind, Reuse, TracedType, Usage
from roverlink.generator.lock import Burned, PastUse
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField

if TYPE_CHECKING:
    from roverlink.generator.lint.history import History

_Declared: TypeAlias = ProtoField | ProtoEnumValue


def not_accepted(context: Context, type: TracedType, reuses: Iterable[Reuse]) -> Iterator[Reuse]:
    """Yield the reuses of one number of a message or enum that the user has not accepted.

    A reuse is accepted if both meanings are, even if one of them got another name since.
    """
    history = context.past.history if context.past else None
    for reuse in reuses:
        known = {use for burned in accepted(context, type, reuse.number) for use in burned.uses}
        if history is None or not known or not _is_known(history, type, reuse, known):
            yield reuse


def accepted(context: Context, type: TracedType, number: int) -> list[Burned]:
    """Return what the user has accepted about a number of a message or enum, under each name that this type had."""
    burned = (context.ledger.burned_in(name).get(number) for name in type.names)
    return [entry for entry in burned if entry]


def _is_known(history: History, type: TracedType, reuse: Reuse, known: set[PastUse]) -> bool:
    if reuse.kind is Kind.REPLACED and reuse.new and reuse.new.digest not in {use.content for use in known}:
        return False
    sides = ({reuse.earlier, *reuse.same_as_earlier}, {reuse.later, *reuse.same_as_later})
    return all(any(not known.isdisjoint(_spelled(history, type, usage)) for usage in usages) for usages in sides)


def _spelled(history: History, type: TracedType, usage: Usage) -> set[PastUse]:
    """Return a usage with each name that its type had. Older ledgers have the type as the .proto file wrote it."""
    names = {*history.types_of(type.id, usage), usage.type.lstrip(".")}
    return {_use(usage.label, name, usage.name) for name in names}


def has_meaning(history: History, type: TracedType, usage: Usage, meaning: PastUse) -> bool:
    """Return True if a usage of a number of the message or enum has the meaning, under any name of its type."""
    return meaning in _spelled(history, type, usage)


def _use(label: str, type: str, name: str, content: str = "") -> PastUse:
    """Return a meaning as the ledger stores it. A list and a single value are different meanings."""
    return PastUse(f"repeated {type}" if label == "repeated" else type, name, content)


def meanings(history: History, type: TracedType, reuses: Iterable[Reuse]) -> list[PastUse]:
    """Return the meanings that some reuses of one number are about, as the ledger stores them."""
    found: dict[PastUse, None] = {}
    for reuse in reuses:
        for usage in (reuse.earlier, reuse.later):
            found[_use(usage.label, history.types_of(type.id, usage)[0], usage.name)] = None
        if reuse.kind is Kind.REPLACED and reuse.new:
            of = reuse.later
            found[_use(of.label, history.types_of(type.id, of)[0], of.name, reuse.new.digest)] = None
    return list(found)


def meaning_of(declared: _Declared) -> PastUse:
    """Return the meaning that a declaration of today gives to its number, as the ledger stores it."""
    if isinstance(declared, ProtoField):
        return _use(declared.label, declared.wire_type, declared.name)
    return PastUse("", declared.name)


def is_accepted(context: Context, owner: str, old: _Declared, *new: _Declared) -> bool:
    """Return True if the user has accepted that a number was ``old`` and is ``new`` now.

    Both are declarations in the message or enum ``owner``. Aliases of an enum give several new ones.
    """
    return any(context.ledger.settles(owner, fact.number, meaning_of(old), meaning_of(fact)) for fact in new)


def number_to_accept(context: Context, owner: str, number: int) -> str:
    """Return a number as ``--accept`` takes it: ``18`` for a payload of a table, otherwise ``rover.ImuInfo:3``."""
    of_table = context.table.proto.root and owner == context.table.envelope.message
    return str(number) if of_table else f"{owner}:{number}"


def command_to_accept(context: Context, owner: str, number: int) -> str:
    """Return the command that accepts the past of a number."""
    tree = f" {shlex.quote(context.tree)}" if context.tree else ""
    return f"roverlink lint --history{tree} --accept {number_to_accept(context, owner, number)}"
