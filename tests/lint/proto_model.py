"""A model of a tree of .proto files for made-up histories: immutable states, their text, and a three-way merge."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

from random_names import Meaning

_WIRE = {"int64": "int32", "uint64": "uint32"}  # types that read the same bytes as the other one

Key = TypeVar("Key")
Value = TypeVar("Value")

Use = tuple[Meaning | int, str, bool]  # a meaning, a format on the wire, and True for a list


@dataclass(frozen=True)
class Member:
    """A field, an enum value, or a payload of the envelope.

    `type` is a scalar type, the id of a type, or empty for an enum value. `meaning` is what the number stands for; of a
    payload, it is the id of its type.
    """

    number: int
    name: str
    type: str | int
    meaning: Meaning | int
    repeated: bool = False

    @property
    def use(self) -> Use:
        """What receivers make of the number: its meaning and its format on the wire."""
        return self.meaning, _WIRE.get(self.type, self.type) if isinstance(self.type, str) else "type", self.repeated


@dataclass(frozen=True)
class Type:
    """A message or an enum. `id` stays the same whatever it is called and wherever it stands."""

    id: int
    keyword: str
    name: str
    file: int
    outer: int | None = None
    members: Mapping[int, Member] = field(default_factory=dict)
    reserved: frozenset[int] = frozenset()
    prefix: str = ""  # of the values of an enum
    is_envelope: bool = False

    def with_member(self, member: Member) -> Type:
        """Return the type with a member, which replaces the one that has its number."""
        members = dict(sorted({**self.members, member.number: member}.items()))
        return replace(self, members=members, reserved=self.reserved - {member.number})

    def without(self, number: int) -> Type:
        """Return the type without a member."""
        return replace(self, members={key: one for key, one in self.members.items() if key != number})


@dataclass(frozen=True)
class File:
    """A .proto file: its path below the proto root, and its package."""

    path: str
    package: str


@dataclass(frozen=True)
class State:
    """All types and files at one commit, by id. `root` is the folder of the files, `others` are files elsewhere."""

    root: str
    files: Mapping[int, File]
    types: Mapping[int, Type]
    others: Mapping[str, str] = field(default_factory=dict)

    def with_type(self, *types: Type) -> State:
        """Return the state with these types in place of those with their ids."""
        return replace(self, types={**self.types, **{one.id: one for one in types}})

    def without_type(self, id: int) -> State:
        """Return the state without a type and the types in it."""
        gone = {id, *(one.id for one in self.types.values() if one.outer == id)}
        return replace(self, types={key: one for key, one in self.types.items() if key not in gone})

    def with_file(self, id: int, file: File) -> State:
        """Return the state with this file in place of the one with this id."""
        return replace(self, files={**self.files, id: file})

    def full_name(self, id: int) -> str:
        """Return the package, the messages around a type, and its name."""
        one = self.types[id]
        around = self.full_name(one.outer) if one.outer is not None else self.files[one.file].package
        return f"{around}.{one.name}" if around else one.name

    def names(self) -> dict[int, str]:
        """Return the full name of each type."""
        return {id: self.full_name(id) for id in self.types}

    def inside(self, id: int | None) -> list[Type]:
        """Return the types in a message; None stands for the top level."""
        return [one for one in self.types.values() if one.outer == id]

    def users(self, id: int) -> list[int]:
        """Return the types that have a member of a type."""
        return [one.id for one in self.types.values() if any(member.type == id for member in one.members.values())]

    def compiles(self) -> bool:
        """False if protoc rejects the state, or if a type has no place in it."""
        names = list(self.names().values()) if self._is_complete() else []
        paths = [file.path for file in self.files.values()]
        return (
            bool(names)
            and len(names) == len(set(names))
            and len(paths) == len(set(paths))
            and all(map(_has_distinct_names, self.types.values()))
            and not self._imports_in_circles()
        )

    def texts(self) -> dict[str, str]:
        """Return the text of each file, by path."""
        return {
            **self.others,
            **{f"{self.root}/{file.path}": "\n".join(self._lines(id)) + "\n" for id, file in self.files.items()},
        }

    def _is_complete(self) -> bool:
        return all(self._has_place(one) for one in self.types.values()) and all(
            member.type in self.types
            for one in self.types.values()
            for member in one.members.values()
            if isinstance(member.type, int)
        )

    def _has_place(self, one: Type) -> bool:
        """False if its file or the message around it is missing; types are nested one deep."""
        if one.outer is None:
            return one.file in self.files
        around = self.types.get(one.outer)
        return around is not None and (around.file, around.outer, around.keyword) == (one.file, None, "message")

    def _imports(self, file: int) -> set[int]:
        used = {
            self.types[member.type].file
            for one in self.types.values()
            if one.file == file
            for member in one.members.values()
            if isinstance(member.type, int)
        }
        return used - {file}

    def _imports_in_circles(self) -> bool:
        left = {file: self._imports(file) for file in self.files}
        while free := [file for file, used in left.items() if not used & set(left)]:
            for file in free:
                del left[file]
        return bool(left)

    def _lines(self, file: int) -> Iterator[str]:
        yield 'syntax = "proto3";'
        if package := self.files[file].package:
            yield f"package {package};"
        for path in sorted(self.files[other].path for other in self._imports(file)):
            yield f'import "{path}";'
        for one in self.inside(None):
            if one.file == file:
                yield ""
                yield from self._declaration(one)

    def _declaration(self, one: Type) -> Iterator[str]:
        yield f"{one.keyword} {one.name} {{"
        if one.reserved:
            yield f"  reserved {', '.join(map(str, sorted(one.reserved)))};"
        for inner in self.inside(one.id):
            yield from (f"  {line}" for line in self._declaration(inner))
        members = [f"  {self._spelled(one, member)};" for member in one.members.values()]
        yield from ["  oneof payload {", *(f"  {line}" for line in members), "  }"] if one.is_envelope else members
        yield "}"

    def _spelled(self, one: Type, member: Member) -> str:
        type = member.type if isinstance(member.type, str) else self._reference(one, member.type)
        words = ["repeated" if member.repeated else "", type, member.name, "=", str(member.number)]
        return " ".join(word for word in words if word)

    def _reference(self, one: Type, id: int) -> str:
        if self.types[id].outer == one.id:
            return self.types[id].name
        package = self.files[one.file].package
        return self.full_name(id).removeprefix(f"{package}." if package else "")


def _has_distinct_names(one: Type) -> bool:
    names = [member.name.replace("_", "").lower() for member in one.members.values()]
    return len(names) == len(set(names)) and not (one.is_envelope and not names)


def merged(base: State, ours: State, theirs: State) -> State:
    """Merge two states as git does by lines; where both changed the same thing, ours stays."""
    types = _merged_maps(base.types, ours.types, theirs.types)
    for id in types.keys() & base.types.keys() & ours.types.keys() & theirs.types.keys():
        types[id] = _merged_types(base.types[id], ours.types[id], theirs.types[id])
    return State(
        root=_picked(base.root, ours.root, theirs.root),
        files=_merged_maps(base.files, ours.files, theirs.files),
        types=types,
        others=_merged_maps(base.others, ours.others, theirs.others),
    )


def _picked(base: Value, ours: Value, theirs: Value) -> Value:
    return theirs if ours == base else ours


def _merged_maps(base: Mapping[Key, Value], ours: Mapping[Key, Value], theirs: Mapping[Key, Value]) -> dict[Key, Value]:
    keys = [*ours, *(key for key in theirs if key not in ours)]
    found = {key: _picked(base.get(key), ours.get(key), theirs.get(key)) for key in keys}
    return {key: value for key, value in found.items() if value is not None}


def _merged_types(base: Type, ours: Type, theirs: Type) -> Type:
    name, file, outer = (
        _picked(getattr(base, part), getattr(ours, part), getattr(theirs, part)) for part in ("name", "file", "outer")
    )
    members = _merged_maps(base.members, ours.members, theirs.members)
    reserved = (ours.reserved | theirs.reserved) - set(members)
    return replace(ours, name=name, file=file, outer=outer, members=dict(sorted(members.items())), reserved=reserved)
