"""Reuses: numbers of a message or enum that had different meanings (usages) in the history."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, groupby

from roverlink.generator.lint.comparison.field_type_changes import broken_by_kind
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.same_meaning import (
    ValueNames,
    alike,
    is_telling,
    nearly_the_same,
    replaced,
    simple,
    survivors,
)
from roverlink.generator.lint.history.usage_model import Confidence, Content, Kind, Relation, Reuse
from roverlink.generator.lint.history.usage_relations import Relations
from roverlink.generator.lint.history.usages import TracedUsage
from roverlink.generator.protos.parser import SCALARS
from roverlink.generator.protos.schema import Fact

# A number that had two names or two types is not always a reuse: teams rename fields, move messages between packages
# and split them into files. A rule that reports each of these would be turned off. So two usages of a number are
# compared in this order:
# - Both scalars, or an enum and an integer: the encoding decides first (encoding guide, "Message Structure"), then the
#   names. `speed` in place of `speed_mps` is the same meaning; `angle` in place of `speed` is not.
# - Both messages: their fields decide. A message that kept most of its fields was renamed. Bytes carry no name of a
#   type, so content is all that counts for a receiver.
# - One message at different times: it kept its name, but most of its fields were replaced under the same numbers.
#
# Each comparison uses the contents at the nodes where one usage ended and the other one began, because the fields of a
# message change with time.

_MOST = 16  # each usage of a number is compared with this many usages before it


class Reuses:
    """Finder of the reuses of one message or enum: compares the usages (meanings) of each number with each other."""

    def __init__(self, record: Record, owner: int, traced: Sequence[TracedUsage]) -> None:
        self._record, self._traced = record, traced
        self._owner = record.types[owner].name
        self._relations = Relations(record, owner)
        self._survivors: dict[tuple[str, str, str, str], int] = {}
        self._values = ValueNames(self._owner, [one.usage.name for one in traced])

    def all(self) -> Iterator[Reuse]:
        """Yield all reuses (changes of meaning) of the numbers of the message or enum, sorted by number."""
        for _, group in groupby(self._traced, key=lambda one: one.usage.number):
            uses = list(group)
            if len(uses) > 1:
                yield from self._between(uses)
            for use in uses:
                yield from self._within(use)

    # --- usages that differ -----------------------------------------------------------------------------------------

    def _between(self, uses: Sequence[TracedUsage]) -> list[Reuse]:
        """Return the reuses (changes of meaning) between the usages of one number.

        A chain of mere renames counts as one meaning.
        """
        meaning = list(range(len(uses)))
        found: list[tuple[int, int, Reuse]] = []
        for one, other in combinations(range(len(uses)), 2):
            # The comparison of all pairs would be quadratic in the usages of a number, which a generated or merged file
            # may have hundreds of.
            if other - one > _MOST:
                continue
            reuse = self._compare(uses[one], uses[other])
            # If A was renamed to B and B to C, then A and C are one meaning, although their names may share no word.
            if reuse is None or not reuse.real:
                old, new = meaning[other], meaning[one]
                meaning = [new if each == old else each for each in meaning]
            if reuse is not None:
                found.append((one, other, reuse))
        return [reuse for one, other, reuse in found if not reuse.real or meaning[one] != meaning[other]]

    def _compare(self, earlier: TracedUsage, later: TracedUsage) -> Reuse | None:
        """Compare two usages of a number, and return the reuse; None if both have the same meaning.

        A field that only got a new name gives a reuse of the kind `Kind.RENAMED`.
        """
        old, new = earlier.usage.fact, later.usage.fact
        before, after = self._relations.nodes(earlier, later)
        # Both are enum values. Two names with one number in one state are an alias (`allow_alias`), which is no reuse.
        if not (old.type or new.type):
            alias = self._relations.together(old, new)
            kind = None if alias or self._values.share_a_word(old.name, new.name) else Kind.MEANING
            return self._reuse(kind, earlier, later, None, None)
        contents = self._content(earlier, before), self._content(later, after)
        if old.type in SCALARS and new.type in SCALARS:
            wire = broken_by_kind(old.type, new.type)
            return self._reuse(Kind.RETYPED if wire else _by_name(old, new), earlier, later, *contents)
        if old.type in SCALARS or new.type in SCALARS:
            return self._reuse(self._scalar_or_not(old, new, contents), earlier, later, *contents)
        return self._reuse(self._by_content(earlier, later, before, after, contents), earlier, later, *contents)

    def _scalar_or_not(self, old: Fact, new: Fact, contents: tuple[Content | None, Content | None]) -> Kind | None:
        """Return the kind of a change between a scalar type and a message or enum; None if the meaning stayed.

        ``contents`` are the contents of the old and the new type. An enum is encoded as an integer, so a change between
        an enum and an integer is compatible.
        """
        content = contents[0] or contents[1]
        enum = content is not None and content.enum
        kinds = [fact.type if fact.type in SCALARS else "enum" if enum else "message" for fact in (old, new)]
        return Kind.RETYPED if broken_by_kind(kinds[0], kinds[1]) else _by_name(old, new)

    def _by_content(
        self,
        earlier: TracedUsage,
        later: TracedUsage,
        before: int,
        after: int,
        contents: tuple[Content | None, Content | None],
    ) -> Kind | None:
        """Return the kind of a change from one message or enum type to another; None if the meaning stayed.

        The types are compared by their contents. ``before`` is the last node that has the earlier usage, and ``after``
        is the first node that has the later usage.
        """
        old, new = earlier.usage.fact, later.usage.fact
        one, other = contents
        if one and other and one.enum != other.enum:
            return Kind.RETYPED
        moved = one and other and one.id == other.id and simple(old.type) == simple(new.type)
        if old.type == new.type or moved:
            same_payload = bool(old.oneof and new.oneof)  # the meaning of a oneof's member is its type
            return (Kind.RENAMED if old.name != new.name else None) if same_payload else _by_name(old, new)
        if "map<" in (old.type[:4], new.type[:4]) or "group" in (old.type, new.type):
            return Kind.RETYPED
        if self._is_renamed(earlier, later, before, after, contents):
            return Kind.RENAMED
        return Kind.RETYPED if one and one.enum else Kind.REUSED

    def _is_renamed(
        self,
        earlier: TracedUsage,
        later: TracedUsage,
        before: int,
        after: int,
        contents: tuple[Content | None, Content | None],
    ) -> bool:
        """Return True if the later type is the earlier one under a new name.

        Two types that were declared at the same time are different, even if they have the same fields, unless the field
        kept its name. If the number was unused in between, or a message is too small to compare, the names must share a
        word.
        """
        old, new = earlier.usage.fact, later.usage.fact
        one, other = contents
        if one is None or other is None:
            return old.name == new.name and alike(simple(old.type), simple(new.type))
        if not nearly_the_same(one, other, self._surviving(one, other)):
            return False
        beside = one.id != other.id and self._record.declared(one.id, after)
        if beside and self._record.declared(other.id, before):
            return old.name == new.name
        at_a_stroke = self._relations.hands_over(earlier, later)
        return (at_a_stroke and is_telling(one, other)) or alike(old.name, new.name)

    # --- one usage, other contents ----------------------------------------------------------------------------------

    def _within(self, use: TracedUsage) -> Iterator[Reuse]:
        """Yield a reuse for each node at which a field's message type kept its name, but most of its fields changed."""
        versions: list[tuple[int, Content]] = []
        for node in self._relations.nodes_of_content(use):
            new = self._content(use, node)
            if new is None or not new.facts or new.enum:
                continue
            # Only earlier states on the same line of history: two branches may each hold their own version.
            past = [old for earlier, old in versions if self._record.graph.precedes(earlier, node)]
            versions.append((node, new))
            # A change that was reverted is the old content, not a third one.
            known = any(old.facts == new.facts for old in past)
            if past and not known and replaced(past[-1], new, self._surviving(past[-1], new)):
                yield from filter(None, [self._reuse(Kind.REPLACED, use, use, past[-1], new)])

    # --- what is said of both ---------------------------------------------------------------------------------------

    def _content(self, use: TracedUsage, node: int) -> Content | None:
        return self._record.content_of_type(use.usage.type, use.stretches[0].owner, node)

    def _surviving(self, old: Content, new: Content) -> int:
        """Return the number of old fields that still exist in the new content.

        The result is cached for later comparisons.
        """
        key = (old.type, old.commit.id, new.type, new.commit.id)
        if key not in self._survivors:
            self._survivors[key] = survivors(old, new)
        return self._survivors[key]

    def _reuse(
        self, kind: Kind | None, earlier: TracedUsage, later: TracedUsage, old: Content | None, new: Content | None
    ) -> Reuse | None:
        if kind is None:
            return None
        relation = self._relations.relation(earlier, later)
        at_once = relation is Relation.TOGETHER or self._relations.overlap(earlier, later)
        return Reuse(
            owner=self._owner,
            number=later.usage.number,
            kind=kind,
            earlier=earlier.usage,
            later=later.usage,
            relation=relation,
            at_once=at_once and earlier is not later,
            old=old,
            new=new,
            survivors=self._surviving(old, new) if old and new else 0,
            confidence=max(_confidence(earlier, old), _confidence(later, new)),
        )


def _by_name(old: Fact, new: Fact) -> Kind | None:
    if old.name == new.name:
        return None
    return Kind.RENAMED if alike(old.name, new.name) else Kind.MEANING


def _confidence(use: TracedUsage, content: Content | None) -> Confidence:
    """Return how reliable a usage (a meaning of a number) is.

    ``content`` are the fields or values of the usage's type; None if the type is no message or enum, or is unknown.
    """
    type = use.usage.type
    sound = content is not None and content.there and not content.broken
    known = sound or not type or type in SCALARS or type.startswith("map<")
    return use.usage.confidence if known else max(use.usage.confidence, Confidence.LIKELY)
