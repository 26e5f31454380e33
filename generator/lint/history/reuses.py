"""Reuses: numbers of a message or enum that had different meanings (usages) in the history."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import combinations, groupby

from roverlink.generator.git import Commit
from roverlink.generator.lint.comparison.judgement import Kept, Meaning, compare_parts, judge_compounds
from roverlink.generator.lint.history.commit_graph import Graph
from roverlink.generator.lint.history.continuations import Declarations
from roverlink.generator.lint.history.judged_facts import type_state
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.node_judgement import FactAtNode, judge_facts
from roverlink.generator.lint.history.usage_model import Content, Kind, Reuse, Usage
from roverlink.generator.lint.history.usage_relations import Relations
from roverlink.generator.lint.history.usages import TracedUsage
from roverlink.generator.lint.history.word_renames import WordRenames
from roverlink.generator.lint.names.similar_names import is_called_a_rename
from roverlink.generator.lint.names.value_names import shared_words
from roverlink.numerals import counted

# A number that had two names or two types is not always a reuse: teams rename fields, move messages between packages
# and split them into files. A rule that reports each of these would be turned off. So two usages of a number are
# judged as two neighbouring states are (see `judgement`), with the contents of their types at the nodes where one usage
# ended and the other one began, because the fields of a message change with time. One usage is also judged at different
# times: a message may keep its name, and lose most of its fields to others with the same numbers.

_MOST = 16  # each usage of a number is compared with this many usages before it
_KINDS = {
    Meaning.SAME: None,
    Meaning.RENAMED: Kind.RENAMED,
    Meaning.DOUBTFUL: Kind.DOUBTFUL,
    Meaning.UNIT: Kind.UNIT,
    Meaning.OTHER: Kind.MEANING,
    Meaning.WIRE: Kind.RETYPED,
}


class Reuses:
    """Finder of the reuses of one message or enum: compares the usages (meanings) of each number with each other."""

    def __init__(self, record: Record, owner: int, traced: Sequence[TracedUsage], renames: WordRenames) -> None:
        self._record, self._traced, self._id, self._renames = record, traced, owner, renames
        self._owner = record.types[owner].name
        self._relations = Relations(record, owner)
        self._numbers = cache(lambda node: _numbers(record.declared(owner, node)))
        self._kept: dict[tuple[Content, Content], Kept] = {}
        self._names = [usage.usage.name for usage in traced]
        values = [usage.usage.name for usage in traced if not usage.usage.type]
        self._shared = shared_words(self._owner.rpartition(".")[2], values) if values else frozenset()

    def all(self) -> Iterator[Reuse]:
        """Yield all reuses (changes of meaning) of the numbers of the message or enum, sorted by number."""
        for _, group in groupby(self._traced, key=lambda usage: usage.usage.number):
            uses = list(group)
            if len(uses) > 1:
                yield from self._between(uses)
            for use in filter(self._is_own, uses):
                yield from self._within(use)

    # --- usages that differ -----------------------------------------------------------------------------------------

    def _between(self, uses: Sequence[TracedUsage]) -> list[Reuse]:
        """Return the reuses (changes of meaning) between the usages of one number.

        A chain of mere renames counts as one meaning. Between the ends of a chain with doubts, nothing is certain.
        """
        renamed, linked = list(range(len(uses))), list(range(len(uses)))
        found: list[tuple[int, int, Reuse]] = []
        for one, other in combinations(range(len(uses)), 2):
            # The comparison of all pairs would be quadratic in the usages of a number, which a generated or merged file
            # may have hundreds of.
            if other - one > _MOST or not (self._is_own(uses[one]) or self._is_own(uses[other])):
                continue
            reuse = self._compare(uses[one], uses[other])
            # If A was renamed to B and B to C, then A and C are one meaning, although their names may share no word.
            if reuse is None or reuse.kind is Kind.RENAMED:
                _join(renamed, one, other)
            if reuse is None or not reuse.certain:
                _join(linked, one, other)
            if reuse is not None:
                found.append((one, other, reuse))
        return [
            replace(reuse, same_as_earlier=_alike(uses, renamed, one), same_as_later=_alike(uses, renamed, other))
            for one, other, reuse in found
            if _is_open(reuse, one, other, renamed, linked)
        ]

    def _is_own(self, use: TracedUsage) -> bool:
        """Return False for a usage that only a namesake of the message or enum has: see `Record.namesakes`."""
        return any(stretch.owner == self._id for stretch in use.stretches)

    def _compare(self, earlier: TracedUsage, later: TracedUsage) -> Reuse | None:
        """Compare two usages of a number, and return the reuse; None if both have the same meaning and name.

        A field that only got a new name gives a reuse of the kind `Kind.RENAMED`.
        """
        old, new = earlier.usage.fact, later.usage.fact
        if not (old.type or new.type) and self._relations.together(old, new):
            # Two names of values with one number in one state are an alias (`allow_alias`), which is no reuse.
            return None
        before, after = self._relations.nodes(earlier, later)
        handovers = self._relations.handovers(earlier, later)
        judged = judge_facts(
            self._record,
            FactAtNode(earlier.stretches[0].owner, old, before),
            FactAtNode(later.stretches[0].owner, new, after),
            moved=old.name != new.name and bool(self._numbers(before).get(new.name, set()) - {new.number}),
            at_once=bool(handovers),
            shared=self._shared,
        )
        types, judgement = judged.types, judged.judgement
        if types is None:
            judgement = judge_compounds(judgement, old.name, new.name, self._shared, self._names)
        kind, reason = _KINDS[judgement.meaning], judgement.reason
        if judgement.by_words and (rename := self._shows_a_rename(handovers, old.name, new.name)):
            kind, reason = Kind.DOUBTFUL, f"{rename}, but {reason}"
        elif kind is Kind.MEANING and types and types.old.full_name != types.new.full_name:
            kind = Kind.REUSED
        return self._reuse(kind, earlier, later, judged.old, judged.new, reason) if kind else None

    def _shows_a_rename(self, nodes: Sequence[int], old: str, new: str) -> str:
        """Return why the nodes (commits) that replaced a name show that a word was renamed; empty if they do not."""
        subjects = (self._record.graph[node].revision.commit.subject for node in nodes)
        if any(is_called_a_rename(subject, self._owner, old, new, self._shared) for subject in subjects):
            return "the commit is called a rename"
        renamed = any(self._renames.has(node, old, new, self._shared) for node in nodes)
        return "the commit replaces the word in several messages" if renamed else ""

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
            if past and not known and (kept := self._compare_contents(past[-1], new)).is_another_message:
                yield self._reuse(
                    Kind.REPLACED, use, use, past[-1], new, f"{kept.left} of {counted(kept.before, 'field')} left", node
                )

    # --- what is said of both ---------------------------------------------------------------------------------------

    def _content(self, use: TracedUsage, node: int) -> Content | None:
        return self._record.content_of_type(use.usage.type, use.stretches[0].owner, node)

    def _compare_contents(self, old: Content, new: Content) -> Kept:
        """Compare two contents of a message. The result is cached for later comparisons."""
        if (old, new) not in self._kept:
            self._kept[old, new] = compare_parts(type_state(old.type, old), type_state(new.type, new))
        return self._kept[old, new]

    def _reuse(
        self,
        kind: Kind,
        earlier: TracedUsage,
        later: TracedUsage,
        old: Content | None,
        new: Content | None,
        reason: str,
        came: int = Graph.BEGINNING,
    ) -> Reuse:
        return Reuse(
            owner=self._owner,
            number=later.usage.number,
            kind=kind,
            earlier=earlier.usage,
            later=later.usage,
            relation=self._relations.relation(earlier, later),
            old=old,
            new=new,
            reason=reason,
            elsewhere=(elsewhere := self._is_elsewhere(earlier, later, came)),
            unmerged=elsewhere and not self._are_rivals(earlier, later),
            naming=tuple(self._naming(earlier, later)),
        )

    def _is_elsewhere(self, earlier: TracedUsage, later: TracedUsage, came: int) -> bool:
        """Return `Reuse.elsewhere`; ``came`` is the node with which the later meaning began, if both are one usage."""
        if earlier is later:
            return not self._record.is_kept(came)
        return not all(
            any(self._record.is_kept(stretch.lifetime.came) for stretch in use.stretches) for use in (earlier, later)
        )

    def _naming(self, earlier: TracedUsage, later: TracedUsage) -> Iterator[Commit]:
        """Yield the commits of `Reuse.naming`."""
        if self._is_own(earlier) and self._is_own(later):
            return
        for other in sorted({stretch.owner for use in (earlier, later) for stretch in use.stretches} - {self._id}):
            name = self._record.namesakes(self._id)[other]
            yield from (*self._record.naming(self._id, name), *self._record.naming(other, name))

    def _are_rivals(self, earlier: TracedUsage, later: TracedUsage) -> bool:
        """Return True if the state that is judged has one of the meanings, and a branch has the other one today."""
        pairs = (earlier, later), (later, earlier)
        return any(self._stands(one) and (other is one or bool(other.usage.live_at)) for one, other in pairs)

    def _stands(self, use: TracedUsage) -> bool:
        """Return True if the state that is judged has the declaration."""
        record = self._record
        return any(record.has(stretch.owner, use.usage.fact, record.newest) for stretch in use.stretches)


def _numbers(declared: Declarations) -> dict[str, set[int]]:
    """Return the numbers that each name has in the declarations of a message or enum."""
    found: dict[str, set[int]] = {}
    for declaration in declared.values():
        for fact in declaration.facts:
            if not fact.claimed:
                found.setdefault(fact.name, set()).add(fact.number)
    return found


def _join(classes: list[int], one: int, other: int) -> None:
    """Give two usages the same class, together with all usages that are in their classes."""
    old, new = classes[other], classes[one]
    classes[:] = [new if index == old else index for index in classes]


def _alike(uses: Sequence[TracedUsage], classes: Sequence[int], one: int) -> frozenset[Usage]:
    """Return the other usages that have the class of a usage."""
    same = (index for index, each in enumerate(classes) if each == classes[one] and index != one)
    return frozenset(uses[index].usage for index in same)


def _is_open(reuse: Reuse, one: int, other: int, renamed: Sequence[int], linked: Sequence[int]) -> bool:
    """Return True if no chain of other renames explains the change between two usages."""
    if reuse.kind is Kind.RENAMED:
        return True
    classes = linked if reuse.certain else renamed
    return classes[one] != classes[other]
