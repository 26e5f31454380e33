"""Identities of messages and enums: which declarations, in all files of all commits, are one type over time.

A type keeps its identity while a file declares its full name. On one line of history (a chain of commits):

- If a commit removes a type and adds another one, `continuations` decides on evidence if both are the same type.
- A full name that was deleted and comes back is the same type again, unless the type goes on under another name.
- If several files declare one full name at the same time, such as a copy of another project's files, each file has a
  type of its own. If the original is deleted later while the copy is still equal, the copy goes on as the original.

Lines of history that have not met share the type of a full name. A merge takes over what its parents know: if one side
has given the full name to another type, the merge has that one. If both sides added the full name separately, their
types become one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from roverlink.generator.lint.history.commit_graph import Graph, Lines, Node
from roverlink.generator.lint.history.continuations import Place, continuations, equal
from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes

Labels = Mapping[str, int]
"""The ids of the types that a file declares, by full name."""
_NONE: Labels = {}


def identities(graph: Graph, types_of: Callable[[str | None], NumberedTypes]) -> dict[int, dict[str, Labels]]:
    """Walk over all commits of the graph, parents first, and give each declared message and enum an id.

    ``types_of`` returns the messages and enums of a blob, and nothing for None. For each node, the result has the files
    whose types are not those at the first parent, by path.
    """
    walk = _Walk(graph, types_of)
    for node in graph.nodes:
        walk.visit(node)
    return {
        index: {path: {name: walk.root(id) for name, id in labels.items()} for path, labels in files.items()}
        for index, files in walk.labels.items()
    }


@dataclass(frozen=True, slots=True)
class _End:
    """The deletion of a type that does not go on under another name."""

    id: int
    node: int
    path: str


@dataclass(slots=True)
class _State:
    """The types and the blob of each file at one commit. The inner mappings are never changed."""

    labels: dict[str, Labels] = field(default_factory=dict)
    blobs: dict[str, str] = field(default_factory=dict)

    def copy(self) -> _State:
        """Return a copy that may be changed; the inner mappings are shared with this state."""
        return _State(dict(self.labels), dict(self.blobs))

    def id_at(self, place: Place) -> int | None:
        """Return the id of the type at a place; None if the file declares no such type."""
        return self.labels.get(place.path, _NONE).get(place.name)


class _Walk:
    def __init__(self, graph: Graph, types_of: Callable[[str | None], NumberedTypes]) -> None:
        self.labels: dict[int, dict[str, Labels]] = {}
        self.born: list[int] = []
        """For each id, the node at which the type was first declared."""
        self._graph, self._types_of = graph, types_of
        self._lines = Lines(graph, _State())
        self._parent: list[int] = []
        self._enum: list[bool] = []
        self._places: list[set[Place]] = []
        """For each root, all places at which the type was ever declared."""
        self._ends: dict[tuple[str, bool], list[_End]] = {}
        self._ids: dict[tuple[str, bool], list[int]] = {}
        """The ids that were new under each full name, by name and kind."""
        self._named: list[dict[str, int]] = []
        """For each root, the node that first gave each full name to the type."""
        self._paths: dict[str, set[str]] = {}
        """The files that ever declared a full name."""

    def root(self, id: int) -> int:
        """Return the id that stands for all ids of one type."""
        while self._parent[id] != id:
            self._parent[id] = self._parent[self._parent[id]]
            id = self._parent[id]
        return id

    def visit(self, node: Node) -> None:
        """Give ids to the types that a node declares; its parents must have been visited."""
        others = [self._lines.release(parent) for parent in node.parents[1:]]
        state = self._lines.take(node.parents[0])
        before = dict[str, Labels]()
        for parent, theirs in zip(node.parents[1:], others):
            for path, labels in self._merged(state, theirs, node.parents[0], parent):
                before.setdefault(path, state.labels[path])
                state.labels[path] = labels
        removed, added = dict[Place, NumberedType](), dict[Place, NumberedType]()
        ids: dict[Place, int] = {}
        for path, old, new, _ in node.revision.edits:
            labels, types = state.labels.get(path, _NONE), self._types_of(new)
            if new:
                state.blobs[path] = new
            else:
                state.blobs.pop(path, None)
            kept = {name: id for name, id in labels.items() if name in types and types[name].enum == self._enum[id]}
            if len(kept) == len(labels) == len(types):
                continue
            before.setdefault(path, labels)
            state.labels[path] = kept
            known = self._types_of(old)
            for name in labels.keys() - kept.keys():
                place = Place(path, name)
                ids[place], removed[place] = labels[name], known.get(name, _empty(self._enum[labels[name]]))
            added |= {Place(path, name): type for name, type in types.items() if name not in kept}
        self._settle(node, state, others, ids, removed, added)
        changed = {path: state.labels[path] for path in before}
        if changed:
            self.labels[node.index] = changed
            for path in [path for path, labels in changed.items() if not labels]:
                del state.labels[path]
        self._lines.keep(node.index, state)

    # --- merges -----------------------------------------------------------------------------------------------------

    def _merged(self, ours: _State, theirs: _State, our_node: int, their_node: int) -> Iterator[tuple[str, Labels]]:
        """Yield the files of a merge in which another parent has given a full name to another type."""
        for path, labels in theirs.labels.items():
            mine = ours.labels.get(path, labels)
            if mine is labels or mine == labels:
                continue
            changed: dict[str, int] = {}
            for name in sorted(mine.keys() & labels.keys()):
                one, other = self.root(mine[name]), self.root(labels[name])
                if one == other or self._enum[one] != self._enum[other]:
                    continue
                ours_is_new = not self._graph.precedes(self._named[one][name], their_node)
                theirs_is_new = not self._graph.precedes(self._named[other][name], our_node)
                if ours_is_new and theirs_is_new:
                    # A side may have renamed a type that the other side still has.
                    if not self._is_alive(ours, other) and not self._is_alive(theirs, one):
                        self._unite(one, other)
                elif theirs_is_new:
                    changed[name] = other
            if changed:
                yield path, {**mine, **changed}

    def _unite(self, one: int, other: int) -> None:
        root, child = sorted((self.root(one), self.root(other)))
        if root != child:
            self._parent[child] = root
            self._places[root] |= self._places[child]
            for name, node in self._named[child].items():
                self._named[root][name] = min(node, self._named[root].get(name, node))

    # --- types that a node adds or removes --------------------------------------------------------------------------

    def _settle(
        self,
        node: Node,
        state: _State,
        others: Sequence[_State],
        ids: Mapping[Place, int],
        removed: dict[Place, NumberedType],
        added: dict[Place, NumberedType],
    ) -> None:
        """Give ids to the types that a node adds, and note the types that it removes.

        ``state`` has the types that the node neither adds nor removes. ``ids`` are the ids of the removed types.
        """
        taken_over = set()
        for place, type in added.items():
            known = [id for id in (theirs.id_at(place) for theirs in others) if id is not None]
            if known and self._enum[known[0]] == type.enum:
                self._assign(node, state, place, known[0])
                taken_over.add(place)
        # What another parent has deleted, the merge does not remove itself.
        own = {
            place: type for place, type in removed.items() if all(parent.id_at(place) is not None for parent in others)
        }
        new = {place: type for place, type in added.items() if place not in taken_over}
        continued = continuations(own, new) if own and new else {}
        for place, old in continued.items():
            self._assign(node, state, place, ids[old])
        for place in sorted(new.keys() - continued.keys()):
            self._assign(node, state, place, self._found(node, state, place, new[place].enum))
        for place in sorted(removed.keys() - set(continued.values())):
            self._end(node, state, place, ids[place], removed[place])

    def _assign(self, node: Node, state: _State, place: Place, id: int) -> None:
        state.labels[place.path] = {**state.labels.get(place.path, _NONE), place.name: id}
        root = self.root(id)
        self._places[root].add(place)
        self._named[root].setdefault(place.name, node.index)
        self._paths.setdefault(place.name, set()).add(place.path)

    def _found(self, node: Node, state: _State, place: Place, enum: bool) -> int:
        """Return the id for a type that appears: that of an earlier type with the same full name, or else a new id."""
        key, precedes = (place.name, enum), self._graph.precedes
        ended = [
            (end.path == place.path, end.node, end.id)
            for end in self._ends.get(key, ())
            if precedes(end.node, node.index) and not self._is_alive(state, end.id)
        ]
        elsewhere = [
            (place in self._places[self.root(id)], -id, id)
            for id in self._ids.get(key, ())
            if not precedes(self.born[id], node.index) and not self._is_alive(state, id)
        ]
        copied = any(True for _ in self._declared(state, place.name, enum))
        for same_path, _, id in (*sorted(ended, reverse=True), *sorted(elsewhere, reverse=True)):
            if same_path or not copied:
                return id
        return self._new(node, key)

    def _new(self, node: Node, key: tuple[str, bool]) -> int:
        id = len(self.born)
        self.born.append(node.index)
        self._parent.append(id)
        self._enum.append(key[1])
        self._places.append(set())
        self._named.append({})
        self._ids.setdefault(key, []).append(id)
        return id

    def _end(self, node: Node, state: _State, place: Place, id: int, type: NumberedType) -> None:
        """Note that a type ends at a node. If a younger copy is left that still equals it, the copy goes on as it."""
        if self._is_alive(state, id):
            return
        self._ends.setdefault((place.name, type.enum), []).append(_End(id, node.index, place.path))
        copies = list(self._declared(state, place.name, type.enum))
        if len(copies) == 1 and self.root(copies[0][1]) > self.root(id):
            copy = self._types_of(state.blobs[copies[0][0]])[place.name]
            if equal(type, copy):
                self._unite(id, copies[0][1])

    def _is_alive(self, state: _State, id: int) -> bool:
        root = self.root(id)
        held = (state.id_at(place) for place in self._places[root])
        return any(id is not None and self.root(id) == root for id in held)

    def _declared(self, state: _State, name: str, enum: bool) -> Iterator[tuple[str, int]]:
        """Yield path and id of each type with the full name ``name`` that a file declares in a state."""
        for path in sorted(self._paths.get(name, ())):
            id = state.id_at(Place(path, name))
            if id is not None and self._enum[id] == enum:
                yield path, id


def _empty(enum: bool) -> NumberedType:
    """Return a type without fields or values, in place of one whose file cannot be read."""
    return NumberedType((), (), 0, False, enum)
