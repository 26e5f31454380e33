"""Lookups in the history: return the declarations and contents of one message or enum at one node of the graph.

A node is a commit that changes .proto files. A type is a message or an enum; its id stays the same when its full name
or its file changes.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property
from itertools import combinations, product

from roverlink.generator.git import Commit
from roverlink.generator.lint.history.commit_graph import Graph
from roverlink.generator.lint.history.continuations import Declarations, Place
from roverlink.generator.lint.history.lineage import Lifetime, Lineage
from roverlink.generator.lint.history.usage_model import Content, TracedType
from roverlink.generator.protos.parser import SCALARS, map_types
from roverlink.generator.protos.schema import Fact

_NOWHERE: Declarations = {}


class Record:
    """The history of all messages and enums, for lookups by id and node. A node is the index of a commit.

    ``newest`` is the node of the state that is judged. ``tips`` has the nodes of branches and tags, by ref. ``kept``
    are nodes whose history nobody can take back: the last commit of the default branch, and released commits, which
    have a tag.
    """

    def __init__(
        self, graph: Graph, lineage: Lineage, newest: int, tips: Mapping[str, int], kept: Iterable[int] = ()
    ) -> None:
        self.graph, self.lineage, self.newest, self.tips = graph, lineage, newest, tips
        self._kept = graph.past((newest, *kept))
        """An integer whose set bits are the kept nodes and their ancestors."""
        self._nodes_of_tips = sorted({newest, *tips.values()})
        self._nodes_of_changes: dict[int, Sequence[int]] = {}
        self._contents: dict[tuple[int, int], Content] = {}

    # --- names ------------------------------------------------------------------------------------------------------

    @cached_property
    def types(self) -> dict[int, TracedType]:
        """All messages and enums that existed at some time, by id."""
        return {id: self._traced_type(id) for id in self.lineage.changes}

    def _traced_type(self, id: int) -> TracedType:
        changes = self.lineage.changes[id]
        states = [declared for _, declared in sorted(changes.items()) if declared]
        places = [place for declared in [*states, self.declared(id, self.newest)] for place in sorted(declared)]
        names = tuple(dict.fromkeys(place.name for place in reversed(places)))
        return TracedType(id, names, next(iter(states[-1].values())).enum, bool(self.declared(id, self.newest)))

    @cached_property
    def _by_name(self) -> dict[str, list[int]]:
        names: dict[str, list[int]] = {}
        for id, type in self.types.items():
            for name in type.names:
                names.setdefault(name, []).append(id)
        return names

    def named(self, name: str) -> list[int]:
        """Return the ids of the types with a name: those that have it in the newest state, or else that once had it.

        ``name`` is a full name, or the last parts of one, which count if no type ever had exactly the name. There are
        several types if several files declare the name.
        """
        found = self._by_name.get(name)
        if found is None:
            found = [id for other, ids in self._by_name.items() if other.endswith(f".{name}") for id in ids]
            return sorted({id for id in found if self.types[id].exists} or {*found})
        return [id for id in found if name in self.names_at(id, self.newest)] or found

    def named_elsewhere(self, name: str) -> list[tuple[int, str]]:
        """Return the types that a branch or tag declares under a name, besides those that `named` returns.

        Each comes with its full name there. The lineage of a type says nothing about it if another branch gave the name
        to a type of its own.
        """
        types = self.named(name)
        known = {*(full for id in types for full in self.names_at(id, self.newest)), name}
        names = [full for full in sorted(known) if full == name or full.endswith(f".{name}")]
        return [
            (id, full)
            for full in names
            for id in self._by_name.get(full, ())
            if id not in types and any(full in self.names_at(id, node) for node in self._nodes_of_tips)
        ]

    def names_at(self, type: int, node: int) -> Set[str]:
        """Return the full names under which a node declares a message or enum. Usually there is only one."""
        return {place.name for place in self.declared(type, node)}

    def naming(self, type: int, name: str) -> tuple[Commit, ...]:
        """Return the commits that gave a full name to a message or enum: those that added it, and that renamed it."""
        nodes = (node for node in self.lineage.changes[type] if name in self.names_at(type, node))
        return tuple(
            self.graph[node].revision.commit
            for node in nodes
            if not any(name in self.names_at(type, parent) for parent in self.graph[node].parents)
        )

    def facts_under(self, type: int, name: str) -> set[Fact]:
        """Return the facts (fields or values) that a message or enum ever had under a full name."""
        states = self.lineage.changes[type].values()
        named = (state for declared in states for place, state in declared.items() if place.name == name)
        return {fact for state in named for fact in state.facts}

    def namesakes(self, type: int) -> dict[int, str]:
        """Return the types to which another branch has given a full name of the message or enum ``type``.

        The keys are their ids, the values the names. Of two such types, one has the other as its namesake: the one that
        the newest state declares, or else the one with the smaller id.
        """
        return self._namesakes.get(type, {})

    @cached_property
    def _namesakes(self) -> dict[int, dict[int, str]]:
        found: dict[int, dict[int, str]] = {}
        several = len(self._nodes_of_tips) > 1
        for name, ids in self._by_name.items() if several else ():
            if len(ids) > 1:
                ranked = sorted((name not in self.names_at(id, self.newest), id) for id in ids)
                nodes = {id: [node for node in self._nodes_of_tips if name in self.names_at(id, node)] for id in ids}
                for (_, one), (_, other) in combinations(ranked, 2):
                    if self.types[one].name != name:
                        continue  # findings would name a type that has another name today
                    pairs = product(nodes[one], nodes[other])
                    if any(self.are_rivals(name, one, at, other, there) for at, there in pairs):
                        found.setdefault(one, {})[other] = name
        return found

    def are_rivals(self, name: str, one: int, at: int, other: int, there: int) -> bool:
        """Return True if two lines of history have given a full name to two types, each to another one.

        The node ``at`` declares the type ``one`` under the name, and the node ``there`` declares the type ``other``. If
        the lines had the name in common, the lineage of its type tells what became of it.
        """
        both = name in self.names_at(other, at) or name in self.names_at(one, there)
        if both or self.types[one].enum != self.types[other].enum:
            return False
        bases = self.graph.merge_bases(at, there)
        return not any(name in self.names_at(id, base) for base in bases for id in self._by_name[name])

    def resolve(self, type: str, owner: int, node: int) -> int | None:
        """Return the id of a field's type at a node; None if the type is not declared there.

        ``type`` is the name that the field declares, and ``owner`` the id of the message with the field.
        """
        place = self._place_of(owner, node)
        for name in _candidates(type, place.name):
            found = [(other.path != place.path, id) for id, other in self._declared_as(name, node)]
            if found:
                return min(found)[1]
        return None

    def once_resolved(self, type: str, owner: int, node: int) -> list[int]:
        """Return the ids of the types that a field could mean by the name of its type, at any commit."""
        return self._by_name.get(self._once_meant(type, owner, node), [])

    def _once_meant(self, type: str, owner: int, node: int) -> str:
        candidates = _candidates(type, self._place_of(owner, node).name)
        return next((name for name in candidates if name in self._by_name), "")

    def _place_of(self, owner: int, node: int) -> Place:
        """Return path and full name of a type at a node, or at another node if it is not declared there."""
        for place in self.declared(owner, node):
            return place
        return Place("", self.types[owner].name)

    def _declared_as(self, name: str, node: int) -> Iterator[tuple[int, Place]]:
        for id in self._by_name.get(name, ()):
            yield from ((id, place) for place in self.declared(id, node) if place.name == name)

    # --- states -----------------------------------------------------------------------------------------------------

    def declared(self, type: int, node: int) -> Declarations:
        """Return the declarations of a message or enum at a node; empty if no file declares it."""
        return self.lineage.changes[type].get(self._last_change(type, node), _NOWHERE)

    def _last_change(self, type: int, node: int) -> int:
        """Return the latest node up to ``node`` that changed the declarations of a message or enum."""
        if type not in self._nodes_of_changes:
            self._nodes_of_changes[type] = sorted(self.lineage.changes[type])
        # A node without a change has the state of its first parent. Usually the first node tried here is the right one:
        # others are on lines of history that were not merged.
        nodes = self._nodes_of_changes[type]
        for index in range(bisect_right(nodes, node) - 1, -1, -1):
            if self.graph.on_first_parents(nodes[index], node):
                return nodes[index]
        return Graph.BEGINNING

    def content(self, type: int | None, node: int) -> Content | None:
        """Return the fields or values of a message or enum at a node; None if it is not declared there."""
        if type is None or not self.declared(type, node):
            return None
        key = type, self._last_change(type, node)
        if key not in self._contents:
            self._contents[key] = self._content(*key)
        return self._contents[key]

    def _content(self, type: int, node: int) -> Content:
        declared = self.lineage.changes[type][node]
        facts = {fact for declaration in declared.values() for fact in declaration.facts if not fact.claimed}
        (path, name), first = next(iter(declared.items()))
        broken = any(declaration.broken for declaration in declared.values())
        commit = self.graph[node].revision.commit
        return Content(type, name, commit, tuple(sorted(facts)), path, first.line, broken, first.enum)

    def content_of_type(self, type: str, owner: int, node: int) -> Content | None:
        """Return the fields or values of a field's type at a node; None if they are unknown.

        ``owner`` is the id of the message with the field. If the type is not declared at the node, an earlier or later
        commit may have renamed it. Then this returns the last content before the node, or else the first content after
        the node.
        """
        id = self.resolve(type, owner, node)
        if id is not None:
            return self.content(id, node)
        name = self._once_meant(type, owner, node)
        versions = [
            (index, id)
            for id in self._by_name.get(name, ())
            for index, declared in self.lineage.changes[id].items()
            if any(place.name == name for place in declared)
        ]
        # The version just before the node, on its own line of history: larger numbers are later.
        before = max((version for version in versions if self.graph.precedes(version[0], node)), default=None)
        found = before or min((version for version in versions if self.graph.precedes(node, version[0])), default=None)
        content = self.content(found[1], found[0]) if found else None
        return replace(content, there=False) if content else None

    def is_kept(self, node: int) -> bool:
        """Return False if only branches that are not merged contain a node, so that it may still change."""
        return bool(self._kept >> node & 1)

    def has(self, owner: int, fact: Fact, node: int) -> bool:
        """Return True if the message or enum ``owner`` declares the fact (a field or value) at a node."""
        return any(fact in declaration.facts for declaration in self.declared(owner, node).values())

    def before(self, owner: int, fact: Fact, node: int) -> int:
        """Return the first parent of a node that still has a fact (a field or enum value), which the node deletes."""
        parents = self.graph[node].parents
        return next((parent for parent in parents if self.has(owner, fact, parent)), parents[0])

    def reachable(self, roots: Iterable[int], node: int) -> set[int]:
        """Return the ids of some messages, and of all messages and enums in their fields at a node, at any depth."""
        found: set[int] = set()
        waiting = list(roots)
        while waiting:
            id = waiting.pop()
            if id not in found:
                found.add(id)
                types = {fact.type for type in self.declared(id, node).values() for fact in type.facts}
                types |= {values for _, values in filter(None, map(map_types, types))}
                waiting += [other for other in (self.resolve(type, id, node) for type in types) if other is not None]
        return found

    # --- facts ------------------------------------------------------------------------------------------------------

    def lifetimes(self, owner: int) -> Iterator[tuple[int, Lifetime]]:
        """Yield the lifetimes of all facts (fields or values) of a message or enum, with their indices."""
        return enumerate(self.lineage.lifetimes.get(owner, []))

    def only_in_broken_files(self, owners: Iterable[int]) -> set[Fact]:
        """Return the facts (fields or values) of the messages or enums ``owners`` that no sound file declares.

        All files from which they were read have syntax errors.
        """
        sound, broken = set[Fact](), set[Fact]()
        for owner in owners:
            for declared in self.lineage.changes[owner].values():
                for declaration in declared.values():
                    (broken if declaration.broken else sound).update(declaration.facts)
        return broken - sound


def _candidates(type: str, scope: str) -> list[str]:
    """Return the full names that a field's type may mean, by protobuf's rules for names, the innermost scope first.

    ``scope`` is the full name of the message with the field. Scalars and maps have none.
    """
    if not type or type in SCALARS or type.startswith("map<"):
        return []
    if type.startswith("."):
        return [type[1:]]
    scopes = scope.split(".")
    return [".".join([*scopes[:end], type]) for end in range(len(scopes), 0, -1)] + [type]
