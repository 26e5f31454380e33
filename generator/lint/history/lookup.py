"""Lookups in the history: return the declarations and contents of one message or enum at one node of the graph.

A node is a commit that changes .proto files.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

from roverlink.generator.lint.history.commit_graph import Graph
from roverlink.generator.lint.history.lineage import Declared, Lifetime, Lineage
from roverlink.generator.lint.history.usage_model import Confidence, Content
from roverlink.generator.protos.parser import SCALARS
from roverlink.generator.protos.schema import Fact


class Record:
    """The history of all messages and enums, for lookups by name and node. A node is the index of a commit."""

    def __init__(self, graph: Graph, lineage: Lineage) -> None:
        self.graph, self.lineage = graph, lineage
        self._last_changes: dict[str, Sequence[int]] = {}
        self._contents: dict[tuple[str, int], Content] = {}

    @cached_property
    def _by_simple_name(self) -> dict[str, list[str]]:
        names: dict[str, list[str]] = {}
        for name in sorted(self.lineage.changes):
            names.setdefault(name.rpartition(".")[2], []).append(name)
        return names

    # --- names ------------------------------------------------------------------------------------------------------

    def owners(self, name: str) -> list[str]:
        """Return the full names that a message or enum had; there are several if its package changed.

        ``name`` is a full name, or a name without package. Another message that existed at the same time as the message
        ``name`` is a different message, and is left out. If no message has exactly the name, this returns all messages
        with the name in any package.
        """
        found = self.of_simple_name(name)
        if name not in found:
            return [other for other in found if other.endswith(f".{name}")]
        return [name, *(other for other in found if other != name and not self._beside(name, other))]

    def _beside(self, one: str, other: str) -> bool:
        """Return True if some node declares both messages, so that they cannot be one message that was moved."""
        nodes = {*self.lineage.changes[one], *self.lineage.changes[other]}
        return any(self.declared(one, node) and self.declared(other, node) for node in nodes)

    def resolve(self, type: str, owner: str, node: int) -> str | None:
        """Return the full name of a field's type at a node; None if the type is not declared there.

        ``owner`` is the full name of the message with the field. If protobuf's rules for names find no type, our parser
        may have failed to read the package statement. Then this returns any type with the same last part of the name.
        """
        if not type or type in SCALARS or type.startswith("map<"):
            return None
        # protobuf searches a name from the innermost scope outwards; a leading dot starts at the outermost one
        # (Language Guide, "Packages and Name Resolution").
        scope = "" if type.startswith(".") else owner
        while True:
            candidate = f"{scope}.{type}".lstrip(".")
            if self.declared(candidate, node):
                return candidate
            if not scope:
                break
            scope = scope.rpartition(".")[0]
        return next((other for other in self.of_simple_name(type) if self.declared(other, node)), None)

    def of_simple_name(self, name: str) -> Sequence[str]:
        """Return the full names of all messages and enums with the same last part: a.Foo and b.Foo for ``Foo``."""
        return self._by_simple_name.get(name.rpartition(".")[2], ())

    # --- states -----------------------------------------------------------------------------------------------------

    def declared(self, owner: str, node: int) -> Declared:
        """Return the declarations of the message or enum ``owner`` at a node, by file; empty if no file declares it."""
        changes = self.lineage.changes.get(owner)
        return changes.get(self._last_change(owner, node), {}) if changes else {}

    def _last_change(self, owner: str, node: int) -> int:
        """Return the latest node (commit) up to ``node`` that changed the declarations of a message or enum."""
        if owner not in self._last_changes:
            changes, last = self.lineage.changes[owner], [Graph.BEGINNING]
            # One pass over the graph answers this for all nodes: a node without a change has the state of its first
            # parent.
            for each in self.graph.nodes:
                last.append(each.index if each.index in changes else last[each.parents[0]])
            self._last_changes[owner] = last
        return self._last_changes[owner][node]

    def content(self, owner: str | None, node: int) -> Content | None:
        """Return the fields or values of a message or enum at a node; None if it is not declared there."""
        if owner is None or not self.declared(owner, node):
            return None
        key = owner, self._last_change(owner, node)
        if key not in self._contents:
            self._contents[key] = self._content(*key)
        return self._contents[key]

    def _content(self, owner: str, node: int) -> Content:
        declared = self.lineage.changes[owner][node]
        facts = {fact for declaration in declared.values() for fact in declaration.facts if not fact.claimed}
        path, first = next(iter(declared.items()))
        broken = any(declaration.broken for declaration in declared.values())
        commit = self.graph[node].revision.commit
        return Content(owner, commit, tuple(sorted(facts)), path, first.line, broken, first.enum)

    def content_of_type(self, type: str, owner: str, node: int) -> Content | None:
        """Return the fields or values of a field's type at a node; None if they are unknown.

        ``owner`` is the full name of the message with the field. If the type is not declared at the node, an earlier or
        later commit may have renamed it. Then this returns the last content before the node, or else the first content
        after the node.
        """
        if name := self.resolve(type, owner, node):
            return self.content(name, node)
        versions = [
            (index, name)
            for name in self.of_simple_name(type)
            for index, declared in self.lineage.changes[name].items()
            if declared
        ]
        # The version just before the node, on its own line of history: larger numbers are later.
        before = max((each for each in versions if self.graph.precedes(each[0], node)), default=None)
        found = before or min((each for each in versions if self.graph.precedes(node, each[0])), default=None)
        content = self.content(found[1], found[0]) if found else None
        return replace(content, there=False) if content else None

    def has(self, owner: str, fact: Fact, node: int) -> bool:
        """Return True if the message or enum ``owner`` declares the fact (a field or value) at a node."""
        return any(fact in declaration.facts for declaration in self.declared(owner, node).values())

    def before(self, owner: str, fact: Fact, node: int) -> int:
        """Return the first parent of a node that still has a fact (a field or enum value), which the node deletes."""
        parents = self.graph[node].parents
        return next((parent for parent in parents if self.has(owner, fact, parent)), parents[0])

    # --- facts ------------------------------------------------------------------------------------------------------

    def lifetimes(self, owner: str) -> Iterator[tuple[int, Lifetime]]:
        """Yield the lifetimes of all facts (fields or values) of the message or enum ``owner``, with their indices."""
        return enumerate(self.lineage.lifetimes.get(owner, []))

    def confidence(self, owners: Iterable[str]) -> dict[Fact, Confidence]:
        """Return how reliable each fact (a field or value) of the messages or enums ``owners`` is.

        A fact is less reliable if it was read from files with syntax errors.
        """
        sound, broken = set[Fact](), set[Fact]()
        for owner in owners:
            for declared in self.lineage.changes.get(owner, {}).values():
                for declaration in declared.values():
                    (broken if declaration.broken else sound).update(declaration.facts)
        doubted = {fact: Confidence.LIKELY if fact in sound else Confidence.DOUBTFUL for fact in broken}
        return {**dict.fromkeys(sound, Confidence.CERTAIN), **doubted}
