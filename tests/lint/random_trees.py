"""Trees of .proto files made up at random: immutable states, their text, a merge, and changes that people make.

Nobody can dispute which names mean the same. Two names mean the same if they differ by spelling, by the order of the
words, by an added qualifier or by a usual abbreviation. They mean different things if they name two quantities, or if
one is the opposite of the other.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from random import Random
from typing import TypeVar

_SUBJECTS = ("motor", "battery", "gripper", "boom", "tank", "mast", "wheel", "hull", "drill", "antenna")
_QUANTITIES = [
    *("voltage", "temperature", "humidity", "pressure", "brightness", "torque", "mass", "position", "resistance")
]
_ABBREVIATED = {"temperature": "temp", "position": "pos"}
_OPPOSITE = {"left": "right", "front": "rear", "min": "max", "start": "stop", "x": "y", "read": "write"}
_OPPOSITE |= {second: first for first, second in _OPPOSITE.items()}
_ACTIVITIES = ["DRIVING", "CHARGING", "HOMING", "SLEEPING", "LIFTING", "TURNING", "DIGGING", "SCANNING", "FLYING"]
_BOARDS = ["Arm", "Camera", "Sonar", "Lidar", "Pump", "Winch", "Valve", "Heater", "Beacon", "Radio", "Rover", "Crane"]
_ROLES = ["Info", "Report", "Setup", "Sample", "Order", "Limits", "Frame", "Summary"]
_SCALARS = ("float", "double", "int32", "uint32")
_WIDER = {"int32": "int64", "uint32": "uint64"}  # types that read the same bytes
_NARROW = {wide: narrow for narrow, wide in _WIDER.items()}

_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Meaning:
    """A quantity of a subject, or an activity without a quantity; `side` is a word that has an opposite, or empty."""

    subject: str
    quantity: str = ""
    side: str = ""

    def names(self, prefix: str) -> list[str]:
        """Return names of a field with this meaning, or of a value of an enum whose values have a prefix."""
        words = [word for word in (self.side, self.subject, self.quantity) if word]
        if prefix:
            return [f"{prefix}_{'_'.join(words).upper()}", f"{prefix}_MODE_{'_'.join(words).upper()}"]
        snake = "_".join(words)
        return [
            snake,
            words[0] + "".join(word.title() for word in words[1:]),
            "_".join([self.quantity, *words[:-1]]),
            f"measured_{snake}",
            "_".join([*words[:-1], _ABBREVIATED.get(self.quantity, self.quantity)]),
        ]


Use = tuple[Meaning | int, str]  # a meaning, and a format on the wire


@dataclass(frozen=True)
class Member:
    """A field, an enum value, or a payload of the envelope, whose type and meaning are the id of its message."""

    number: int
    name: str
    type: str | int
    meaning: Meaning | int

    @property
    def use(self) -> Use:
        """What receivers make of the number."""
        wire = _NARROW.get(self.type, self.type) if isinstance(self.type, str) else "type"
        return self.meaning, wire


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

    @property
    def replaceable(self) -> list[Member]:
        """Members that a change may take; the value 0 of an enum stays."""
        return [member for member in self.members.values() if member.number > 0]

    def with_member(self, *members: Member) -> Type:
        """Return the type with members, which replace those that have their numbers."""
        numbered = {member.number: member for member in members}
        merged = dict(sorted({**self.members, **numbered}.items()))
        return replace(self, members=merged, reserved=self.reserved - set(numbered))

    def without(self, number: int) -> Type:
        """Return the type without a member."""
        return replace(self, members={key: one for key, one in self.members.items() if key != number})


@dataclass(frozen=True)
class State:
    """All types and files at one commit, by id; a file is a path below the folder `root`, and a package."""

    root: str
    files: Mapping[int, tuple[str, str]]
    types: Mapping[int, Type]

    def put(self, *types: Type) -> State:
        """Return the state with these types in place of those with their ids."""
        return replace(self, types={**self.types, **{one.id: one for one in types}})

    def without(self, id: int) -> State:
        """Return the state without a type and the types in it."""
        return replace(self, types={key: one for key, one in self.types.items() if id not in (key, one.outer)})

    def with_file(self, id: int, path: str, package: str) -> State:
        """Return the state with this file in place of the one with this id."""
        return replace(self, files={**self.files, id: (path, package)})

    def full_name(self, id: int) -> str:
        """Return the package, the message around a type, and its name."""
        one = self.types[id]
        around = self.files[one.file][1] if one.outer is None else self.full_name(one.outer)
        return f"{around}.{one.name}" if around else one.name

    def inside(self, id: int | None) -> list[Type]:
        """Return the types in a message; None stands for the top level."""
        return [one for one in self.types.values() if one.outer == id]

    def messages(self) -> list[Type]:
        """Return the messages at the top level, but for the envelope."""
        return [one for one in self.inside(None) if one.keyword == "message" and not one.is_envelope]

    def is_used(self, id: int) -> bool:
        """True if a member has the type."""
        return any(member.type == id for one in self.types.values() for member in one.members.values())

    def compiles(self) -> bool:
        """False if protoc rejects the state, or if a type has no place in it."""
        used = {member.type for one in self.types.values() for member in one.members.values()}
        if not all(map(self._has_place, self.types.values())) or {id for id in used if isinstance(id, int)} - set(
            self.types
        ):
            return False
        names = [self.full_name(id) for id in self.types]
        paths = [path for path, _ in self.files.values()]
        types = self.types.values()
        members = ([member.name.replace("_", "").lower() for member in one.members.values()] for one in types)
        lists = [names, paths, *members]
        envelopes = [one for one in self.types.values() if one.is_envelope]
        return (
            bool(names)
            and all(len(each) == len(set(each)) for each in lists)
            and all(one.members for one in envelopes)
            and not self._imports_in_circles()
        )

    def texts(self) -> dict[str, str]:
        """Return the text of each file, by path."""
        return {f"{self.root}/{path}": "\n".join(self._lines(id)) + "\n" for id, (path, _) in self.files.items()}

    def _has_place(self, one: Type) -> bool:
        """False if its file or the message around it is missing; types are nested one deep."""
        if one.outer is None:
            return one.file in self.files
        around = self.types.get(one.outer)
        return around is not None and (around.file, around.outer, around.keyword) == (one.file, None, "message")

    def _imports(self, file: int) -> set[int]:
        inside = [member for one in self.types.values() if one.file == file for member in one.members.values()]
        return {self.types[member.type].file for member in inside if isinstance(member.type, int)} - {file}

    def _imports_in_circles(self) -> bool:
        left = {file: self._imports(file) for file in self.files}
        while free := [file for file, used in left.items() if not used & set(left)]:
            for file in free:
                del left[file]
        return bool(left)

    def _lines(self, file: int) -> Iterator[str]:
        yield 'syntax = "proto3";'
        if package := self.files[file][1]:
            yield f"package {package};"
        for path in sorted(self.files[other][0] for other in self._imports(file)):
            yield f'import "{path}";'
        for one in self.inside(None):
            if one.file == file:
                yield from self._declaration(one)

    def _declaration(self, one: Type) -> Iterator[str]:
        yield f"{one.keyword} {one.name} {{"
        if one.reserved:
            yield f"  reserved {', '.join(map(str, sorted(one.reserved)))};"
        for inner in self.inside(one.id):
            yield from (f"  {line}" for line in self._declaration(inner))
        members = [f"  {self._spelled(one, member)};" for member in one.members.values()]
        yield from ["  oneof payload {", *members, "  }"] if one.is_envelope else members
        yield "}"

    def _spelled(self, one: Type, member: Member) -> str:
        type = member.type
        if isinstance(type, int):
            package = self.files[one.file][1]
            nested = self.types[type].outer == one.id
            type = self.types[type].name if nested else self.full_name(type).removeprefix(f"{package}.")
        return f"{type} {member.name} = {member.number}".strip()


def merged(base: State, ours: State, theirs: State) -> State:
    """Merge two states as git does by lines; where both changed the same thing, ours stays."""
    types = _merged_maps(base.types, ours.types, theirs.types)
    for id in types.keys() & base.types.keys() & ours.types.keys() & theirs.types.keys():
        types[id] = _merged_types(base.types[id], ours.types[id], theirs.types[id])
    files = _merged_maps(base.files, ours.files, theirs.files)
    return State(_picked(base.root, ours.root, theirs.root), files, types)


def _picked(base: _Value, ours: _Value, theirs: _Value) -> _Value:
    return theirs if ours == base else ours


def _merged_maps(
    base: Mapping[_Key, _Value], ours: Mapping[_Key, _Value], theirs: Mapping[_Key, _Value]
) -> dict[_Key, _Value]:
    keys = [*ours, *(key for key in theirs if key not in ours)]
    found = {key: _picked(base.get(key), ours.get(key), theirs.get(key)) for key in keys}
    return {key: value for key, value in found.items() if value is not None}


def _merged_types(base: Type, ours: Type, theirs: Type) -> Type:
    parts = {
        part: _picked(getattr(base, part), getattr(ours, part), getattr(theirs, part))
        for part in ("name", "file", "outer")
    }
    members = dict(sorted(_merged_maps(base.members, ours.members, theirs.members).items()))
    return replace(ours, members=members, reserved=(ours.reserved | theirs.reserved) - set(members), **parts)


class Changes:
    """Changes drawn at random: each method returns the next state, or None if the state does not allow it."""

    def __init__(self, random: Random) -> None:
        self.random = random
        self.ids = itertools.count(1)
        self._names = [board + role for board in _BOARDS for role in _ROLES]
        random.shuffle(self._names)
        self._last_members: dict[tuple[int, int], Member] = {}  # by type and number
        self._meanings: defaultdict[int, set[Meaning | int]] = defaultdict(set)  # by type

    def remember(self, state: State) -> None:
        """Take note of the members and types of a state."""
        for id, one in state.types.items():
            for number, member in one.members.items():
                self._last_members[id, number] = member
                self._meanings[id].add(member.meaning)

    def draw(self, state: State) -> tuple[str, State] | None:
        """Draw the name of a change and its result."""
        (change,) = self.random.choices(list(_WEIGHTS), list(_WEIGHTS.values()))
        after = change(self, state)
        return (change.__name__, after) if after and after != state else None

    # --- new members and types ---

    def new_name(self) -> str:
        """Return a name for a type at the top level that no other one has."""
        return self._names.pop()

    def new_type(self, keyword: str, file: int, name: str, outer: int | None = None) -> Type:
        """Draw a message or an enum with members; an enum has the value 0."""
        prefix = _snake(self.new_name()).upper() if keyword == "enum" else ""
        one = Type(next(self.ids), keyword, name, file, outer, prefix=prefix)
        if prefix:
            one = one.with_member(Member(0, f"{prefix}_UNKNOWN", "", Meaning("UNKNOWN")))
        for number in range(1, self.random.randint(2, 6) + 1):
            if member := self.new_member(State("", {}, {}), one, number):
                one = one.with_member(member)
        return one

    def new_member(self, state: State, one: Type, number: int) -> Member | None:
        """Draw a member with a meaning that the type never had; None if no payload is left."""
        if one.is_envelope:
            left = [other for other in state.messages() if other.id not in self._meanings[one.id]]
            payload = self.random.choice(left) if left else None
            member = payload and Member(number, _snake(payload.name), payload.id, payload.id)
        else:
            side = self.random.choice(sorted(_OPPOSITE)) if self.random.random() < 0.35 else ""
            meaning = self._unused(one, lambda: replace(self._meaning(one), side=side))
            type = "" if one.prefix else self.random.choice(_SCALARS)
            member = self._named(one, number, type, meaning) if meaning else None
        if member:
            self._meanings[one.id].add(member.meaning)
        return member

    def _meaning(self, one: Type) -> Meaning:
        if one.prefix:
            return Meaning(self.random.choice(_ACTIVITIES))
        return Meaning(self.random.choice(_SUBJECTS), self.random.choice(_QUANTITIES))

    def _unused(self, one: Type, draw: Callable[[], Meaning]) -> Meaning | None:
        used = {(use.subject, use.quantity) for use in self._meanings[one.id] if isinstance(use, Meaning)}
        drawn = (draw() for _ in range(20))
        return next((meaning for meaning in drawn if (meaning.subject, meaning.quantity) not in used), None)

    def _named(self, one: Type, number: int, type: str, meaning: Meaning) -> Member:
        return Member(number, self.random.choice(meaning.names(one.prefix)), type, meaning)

    def _other_member(self, state: State, one: Type, old: Member) -> Member | None:
        """Draw a member with another meaning for a number: the opposite, another quantity, or another payload."""
        was, meaning = old.meaning, None
        if one.is_envelope:
            return self.new_member(state, one, old.number)
        if not isinstance(was, Meaning) or not isinstance(old.type, str):
            return None
        if was.side:
            meaning = replace(was, side=_OPPOSITE[was.side])
        if meaning is None or meaning in self._meanings[one.id] or self.random.random() < 0.3:
            part = "subject" if one.prefix else "quantity"
            meaning = self._unused(one, lambda: replace(was, **{part: getattr(self._meaning(one), part)}))
        type = "string" if not one.prefix and self.random.random() < 0.2 else old.type
        return self._named(one, old.number, type, meaning) if meaning else None

    def _renamed(self, one: Type, old: Member) -> Member:
        """Draw another name with the same meaning; payloads keep their name."""
        if not isinstance(old.meaning, Meaning) or not isinstance(old.type, str):
            return old
        return self._named(one, old.number, old.type, old.meaning)

    def _next_number(self, one: Type) -> int:
        """Return a number that the type never had."""
        return 1 + max((number for id, number in self._last_members if id == one.id), default=0)

    # --- what a change is about ---

    def _type(self, state: State) -> Type:
        """Draw a type; most work is done on few types."""
        types = sorted(state.types.values(), key=lambda one: one.id)
        return self.random.choice(types[:3] if self.random.random() < 0.6 else types)

    def _member(self, state: State) -> tuple[Type, Member] | None:
        one = self._type(state)
        return (one, self.random.choice(one.replaceable)) if one.replaceable else None

    def _free_member(self, state: State) -> tuple[Type, Member] | None:
        """Draw an earlier member whose number is free."""
        known = [(state.types[id], member) for (id, _), member in self._last_members.items() if id in state.types]
        free = [(one, member) for one, member in known if member.number not in one.members]
        return self.random.choice(free) if free else None

    def _edited(self, state: State, edit: Callable[[Type, Member], Member | None]) -> State | None:
        """Edit a scalar member."""
        drawn = self._member(state)
        member = edit(*drawn) if drawn and drawn[1].type in (*_SCALARS, *_NARROW, "string") else None
        return state.put(drawn[0].with_member(member)) if drawn and member else None

    # --- members ---

    def add_member(self, state: State) -> State | None:
        """Add a member with a new number."""
        one = self._type(state)
        member = self.new_member(state, one, self._next_number(one))
        return state.put(one.with_member(member)) if member else None

    def delete_member(self, state: State) -> State | None:
        """Delete a member, and reserve its number half of the time."""
        drawn = self._member(state)
        if drawn is None or len(drawn[0].members) < 3:
            return None
        left, number = drawn[0].without(drawn[1].number), drawn[1].number
        reserved = left.reserved | {number} if self.random.random() < 0.5 else left.reserved
        return state.put(replace(left, reserved=reserved))

    def restore_member(self, state: State) -> State | None:
        """Give a free number back to its member, perhaps under another name."""
        drawn = self._free_member(state)
        if drawn is None:
            return None
        one, member = drawn
        return state.put(one.with_member(member if self.random.random() < 0.5 else self._renamed(one, member)))

    def reuse_free_number(self, state: State) -> State | None:
        """Give a free number to a member with another meaning."""
        drawn = self._free_member(state)
        other = self._other_member(state, *drawn) if drawn else None
        return state.put(drawn[0].with_member(other)) if drawn and other else None

    def replace_member(self, state: State) -> State | None:
        """Give a number from one commit to the next to a member with another meaning."""
        drawn = self._member(state)
        other = self._other_member(state, *drawn) if drawn else None
        return state.put(drawn[0].with_member(other)) if drawn and other else None

    def rename_member(self, state: State) -> State | None:
        """Rename a member within its meaning."""
        drawn = self._member(state)
        return state.put(drawn[0].with_member(self._renamed(*drawn))) if drawn else None

    def widen_member(self, state: State) -> State | None:
        """Change the type to one that reads the same bytes."""
        return self._edited(state, lambda one, old: replace(old, type=_WIDER.get(str(old.type), old.type)))

    def retype_member(self, state: State) -> State | None:
        """Change the type to one that reads other bytes, under the same name."""
        return self._edited(state, lambda one, old: replace(old, type="string"))

    # --- types; those that move have members by which one recognizes them ---

    def rename_type(self, state: State) -> State | None:
        """Rename a message or an enum, perhaps with a number that is given away in the same commit."""
        one = self._type(state)
        if len(one.replaceable) < 2:
            return None
        name = f"{one.name}{self.random.choice(['Data', 'Message'])}"
        renamed = replace(one, name=name if self.random.random() < 0.4 else self.new_name())
        if len(one.replaceable) < 4 or self.random.random() < 0.75:
            return state.put(renamed)
        other = self._other_member(state, one, self.random.choice(one.replaceable))
        return state.put(renamed.with_member(other)) if other else None

    def nest_type(self, state: State) -> State | None:
        """Move a type into a message of the same file, or a nested one to the top level."""
        one = self._type(state)
        outers = [outer for outer in state.messages() if outer.file == one.file and outer is not one]
        if one.is_envelope or len(one.replaceable) < 2 or state.inside(one.id) or not (outers or one.outer):
            return None
        return state.put(replace(one, outer=None if one.outer else self.random.choice(outers).id))

    def add_type(self, state: State) -> State | None:
        """Add a message or an enum at the top level."""
        file, keyword = self.random.choice(list(state.files)), self.random.choice(["message", "message", "enum"])
        return state.put(self.new_type(keyword, file, self.new_name()))

    def add_nested_type(self, state: State) -> State | None:
        """Add a nested type with a name that other messages have inside too, and a field of an enum."""
        if not state.messages():
            return None
        outer, name = self.random.choice(state.messages()), self.random.choice(["Type", "Status", "Config", "State"])
        one = self.new_type(self.random.choice(["message", "enum"]), outer.file, name, outer.id)
        member = Member(self._next_number(outer), name.lower(), one.id, Meaning("its", name))
        return state.put(outer.with_member(member) if one.prefix else outer, one)

    def delete_type(self, state: State) -> State | None:
        """Delete a type that nothing uses, with the types in it."""
        unused = [one for one in state.types.values() if not one.is_envelope and not state.is_used(one.id)]
        return state.without(self.random.choice(unused).id) if len(unused) > 1 else None

    # --- files ---

    def move_file(self, state: State) -> State | None:
        """Move a file to another folder, under its name or another one."""
        id = self.random.choice(list(state.files))
        path, package = state.files[id]
        name = self.random.choice([path.rpartition("/")[2], f"{self.new_name().lower()}.proto"])
        return state.with_file(id, self.random.choice(("", "boards/", "common/", "boards/v2/")) + name, package)

    def change_package(self, state: State) -> State | None:
        """Give a file another package, or its first one, or none."""
        id = self.random.choice(list(state.files))
        if any(len(one.replaceable) < 2 for one in state.types.values() if one.file == id):
            return None
        return state.with_file(id, state.files[id][0], self.random.choice(("", "rover", "link_v2", "fleet.core")))

    def move_into_the_root(self, state: State) -> State | None:
        """Move all files from elsewhere in the repository into the proto root."""
        return replace(state, root="protos")


_WEIGHTS: dict[Callable[[Changes, State], State | None], int] = {
    Changes.add_member: 8,
    Changes.delete_member: 20,
    Changes.restore_member: 8,
    Changes.reuse_free_number: 24,
    Changes.replace_member: 6,
    Changes.rename_member: 8,
    Changes.widen_member: 4,
    Changes.retype_member: 2,
    Changes.rename_type: 12,
    Changes.nest_type: 11,
    Changes.add_type: 3,
    Changes.add_nested_type: 5,
    Changes.delete_type: 5,
    Changes.move_file: 6,
    Changes.change_package: 6,
    Changes.move_into_the_root: 6,
}
"""How often each change is drawn."""


def _snake(name: str) -> str:
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
