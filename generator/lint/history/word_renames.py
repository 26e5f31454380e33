"""Words that one commit replaces in several messages, such as `cpu` by `energy`: a rename of the word, and no reuse.

A word counts only if three things are true, because a commit may also reuse the numbers of two messages alike:

- Messages of different names show the same change, with equal types of the fields. A copy of a message proves nothing.
- No declaration in the changed files has the old word any more.
- The names that are judged have another word in common: `speed` may become `current` in two messages by a reuse.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.names.similar_names import word_bases
from roverlink.generator.protos.schema import Fact

_Replacement = tuple[frozenset[str], frozenset[str]]
"""The words that only the old name has, and the words that only the new name has."""


class WordRenames:
    """Finder of the words that a node (a commit) replaces in several messages or enums."""

    def __init__(self, record: Record) -> None:
        self._record = record
        self._changed: dict[int, list[int]] = {}
        """The ids of the messages and enums that each node changes."""
        for id, changes in record.lineage.changes.items():
            for node in changes:
                self._changed.setdefault(node, []).append(id)
        self._replaced_at = cache(self._find)

    def has(self, node: int, old: str, new: str, shared: frozenset[str]) -> bool:
        """Return True if a node replaces the words that two names differ in, in several messages or enums.

        ``shared`` are words that say nothing; see `compare_names`.
        """
        common = word_bases(old) & word_bases(new) - shared
        return bool(common) and _replacement(old, new) in self._replaced_at(node)

    def _find(self, node: int) -> set[_Replacement]:
        types: dict[_Replacement, set[str]] = {}
        for id in self._changed.get(node, ()):
            for old, new in self._renamed(id, node):
                types.setdefault(_replacement(old, new), set()).add(self._record.types[id].name.rpartition(".")[2])
        several = [words for words, names in types.items() if all(words) and len(names) > 1]
        left = self._words_left(node) if several else frozenset[str]()
        return {words for words in several if words[0].isdisjoint(left)}

    def _renamed(self, id: int, node: int) -> Iterator[tuple[str, str]]:
        """Yield the old and the new name of each number that kept its type."""
        before = {fact.number: fact for fact in self._facts(id, self._record.graph[node].parents[0])}
        for fact in self._facts(id, node):
            old = before.get(fact.number, fact)
            if old.name != fact.name and old.type == fact.type:
                yield old.name, fact.name

    def _facts(self, id: int, node: int) -> Iterator[Fact]:
        for declaration in self._record.declared(id, node).values():
            yield from (fact for fact in declaration.facts if not fact.claimed)

    def _words_left(self, node: int) -> frozenset[str]:
        """Return the words of all names in the files that a node changes."""
        paths = {place.path for id in self._changed[node] for place in self._record.declared(id, node)}
        all = (self._record.declared(id, node) for id in self._record.lineage.changes)
        declarations = (type for declared in all for place, type in declared.items() if place.path in paths)
        names = {fact.name for type in declarations for fact in type.facts if not fact.claimed}
        return frozenset(word for name in names for word in word_bases(name))


def _replacement(old: str, new: str) -> _Replacement:
    before, after = word_bases(old), word_bases(new)
    return before - after, after - before
