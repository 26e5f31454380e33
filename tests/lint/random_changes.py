"""Changes that people make to .proto files, drawn at random: each is a function from a state to the next one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from random import Random

from proto_model import File, Member, State, Type
from random_names import Meaning, activity, another_activity, another_quantity, quantity, type_names

_SCALARS = ("float", "double", "int32", "uint32")
_WIDER = {"int32": "int64", "uint32": "uint64"}
_PACKAGES = ("", "rover", "base", "link_v2", "fleet.core")
_FOLDERS = ("", "boards/", "common/", "boards/v2/")
_NESTED_NAMES = ("Type", "Status", "Config", "State")


@dataclass(frozen=True)
class Change:
    """A change of a state; `kind` says in words what it does. `apply` returns None if the state does not allow it."""

    kind: str
    apply: Callable[[State], State | None]


@dataclass
class Draft:
    """Everything that draws need: the random numbers, the names and ids that are left, and what was there before."""

    random: Random
    names: list[str]
    last_members: dict[tuple[int, int], Member] = field(default_factory=dict)  # by type and number
    last_types: dict[int, tuple[Type, ...]] = field(default_factory=dict)  # each with the types inside
    meanings: dict[int, set[Meaning | int]] = field(default_factory=dict)  # by type
    next_id: int = 0

    @classmethod
    def of(cls, random: Random) -> Draft:
        """Begin with all names."""
        return cls(random, type_names(random))

    def new_id(self) -> int:
        """Return an id for a type or a file."""
        self.next_id += 1
        return self.next_id

    def remember(self, state: State) -> None:
        """Take note of the members and types of a state."""
        for id, one in state.types.items():
            self.last_types[id] = (one, *state.inside(id))
            for number, member in one.members.items():
                self.last_members[id, number] = member
                self.meanings.setdefault(id, set()).add(member.meaning)

    def free_members(self, one: Type) -> list[Member]:
        """Return earlier members whose numbers are free."""
        return [
            member for (id, number), member in self.last_members.items() if id == one.id and number not in one.members
        ]

    def next_number(self, one: Type) -> int:
        """Return a number that the type never had."""
        return 1 + max((number for id, number in self.last_members if id == one.id), default=0)

    # --- members ---

    def new_member(self, state: State, one: Type, number: int) -> Member | None:
        """Draw a member with a meaning that the type never had; None if no payload is left."""
        if one.is_envelope:
            return self._payload(state, one, number)
        draw = activity if one.keyword == "enum" else quantity
        meaning = self._unused(one, lambda: draw(self.random))
        if meaning is None:
            return None
        type = "" if one.keyword == "enum" else self.random.choice(_SCALARS)
        return self._named(one, number, type, meaning)

    def other_member(self, state: State, one: Type, old: Member) -> tuple[str, Member] | None:
        """Draw a member with another meaning for a number, and how the two differ."""
        if not isinstance(old.meaning, Meaning):
            found = self._payload(state, one, old.number) if one.is_envelope else None
            return ("another payload", found) if found else None
        was = old.meaning
        how, meaning = "an opposite", was.opposite()
        if meaning in self.meanings.get(one.id, ()) or meaning is None or self.random.random() < 0.3:
            draw = another_activity if one.keyword == "enum" else another_quantity
            how, meaning = "another meaning", self._unused(one, lambda: draw(self.random, was))
        if meaning is None or not isinstance(old.type, str):
            return None
        if one.keyword == "message" and self.random.random() < 0.2:
            how, old = f"{how} and type", replace(old, type="string")
        return how, self._named(one, old.number, str(old.type), meaning)

    def renamed(self, one: Type, old: Member) -> Member:
        """Draw another name with the same meaning; payloads keep their name."""
        if not isinstance(old.meaning, Meaning) or not isinstance(old.type, str):
            return old
        return replace(self._named(one, old.number, old.type, old.meaning), repeated=old.repeated)

    def _named(self, one: Type, number: int, type: str, meaning: Meaning) -> Member:
        names = meaning.value_names(one.prefix) if one.keyword == "enum" else meaning.field_names()
        return Member(number, self.random.choice(names), type, meaning)

    def _payload(self, state: State, one: Type, number: int) -> Member | None:
        used = self.meanings.get(one.id, set())
        left = [
            other
            for other in state.inside(None)
            if other.keyword == "message" and not other.is_envelope and other.id not in used
            # An original and its copy may carry the same fields: then it is open if the number was given away.
            if not _is_vendored(state, other.file)
        ]
        if not left:
            return None
        payload = self.random.choice(left)
        return Member(number, _snake(payload.name), payload.id, payload.id)

    def _unused(self, one: Type, draw: Callable[[], Meaning]) -> Meaning | None:
        used = {(use.subject, use.quantity) for use in self.meanings.get(one.id, ()) if isinstance(use, Meaning)}
        drawn = (draw() for _ in range(20))
        return next((meaning for meaning in drawn if (meaning.subject, meaning.quantity) not in used), None)

    # --- types ---

    def new_type(self, keyword: str, file: int, name: str, outer: int | None = None) -> Type:
        """Draw a message or an enum with members; an enum has the value 0."""
        prefix = _snake(self.names.pop()).upper() if keyword == "enum" else ""
        one = Type(self.new_id(), keyword, name, file, outer, prefix=prefix)
        if keyword == "enum":
            one = one.with_member(Member(0, f"{prefix}_UNKNOWN", "", Meaning("UNKNOWN", "")))
        for number in range(1, self.random.randint(2, 6) + 1):
            member = self.new_member(State("", {}, {}), one, number)
            if member is not None:
                one = one.with_member(member)
                self.meanings.setdefault(one.id, set()).add(member.meaning)
        return one


def _snake(name: str) -> str:
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")


def _is_vendored(state: State, file: int) -> bool:
    return state.files[file].package == "vendor"


# --- changes of members ------------------------------------------------------------------------------------------


def _of_type(kind: str, id: int, change: Callable[[Type], Type | None]) -> Change:
    def apply(state: State) -> State | None:
        one = state.types.get(id)
        changed = change(one) if one is not None else None
        return state.with_type(changed) if changed is not None else None

    return Change(kind, apply)


def _put(kind: str, id: int, member: Member, *, over: bool) -> Change:
    """Give a number to a member: `over` an earlier one, or where the number is free."""
    return _of_type(kind, id, lambda one: one.with_member(member) if (member.number in one.members) == over else None)


def _replaceable(one: Type) -> list[Member]:
    return [member for member in one.members.values() if member.number > 0]


def _drawn_type(draft: Draft, state: State) -> Type:
    """Draw a type; most work is done on few types."""
    types = sorted(state.types.values(), key=lambda one: one.id)
    return draft.random.choice(types[:3] if draft.random.random() < 0.6 else types)


def _drawn_free_member(draft: Draft, state: State) -> tuple[Type, Member] | None:
    free = [(one, member) for one in state.types.values() for member in draft.free_members(one)]
    return draft.random.choice(free) if free else None


def _drawn_member(draft: Draft, state: State) -> tuple[Type, Member] | None:
    one = _drawn_type(draft, state)
    members = _replaceable(one)
    return (one, draft.random.choice(members)) if members else None


def _drawn_scalar(draft: Draft, state: State) -> tuple[Type, Member] | None:
    drawn = _drawn_member(draft, state)
    return drawn if drawn and isinstance(drawn[1].type, str) and drawn[1].type else None


def add_member(draft: Draft, state: State) -> Change | None:
    """Add a member with a new number."""
    one = _drawn_type(draft, state)
    member = draft.new_member(state, one, draft.next_number(one))
    return _put("add a member", one.id, member, over=False) if member else None


def delete_member(draft: Draft, state: State) -> Change | None:
    """Delete a member, and reserve its number half of the time."""
    drawn = _drawn_member(draft, state)
    if drawn is None or len(drawn[0].members) < 3:
        return None
    (one, member), reserve = drawn, draft.random.random() < 0.5

    def delete(one: Type) -> Type | None:
        left = one.without(member.number)
        return replace(left, reserved=left.reserved | {member.number}) if reserve else left

    return _of_type("delete a member and reserve it" if reserve else "delete a member", one.id, delete)


def restore_member(draft: Draft, state: State) -> Change | None:
    """Give a free number back to its member, perhaps under another name."""
    drawn = _drawn_free_member(draft, state)
    if drawn is None:
        return None
    one, member = drawn
    if draft.random.random() < 0.5:
        return _put("restore a member", one.id, member, over=False)
    return _put("restore a member under another name", one.id, draft.renamed(one, member), over=False)


def reuse_free_number(draft: Draft, state: State) -> Change | None:
    """Give a free number to a member with another meaning."""
    drawn = _drawn_free_member(draft, state)
    other = drawn and draft.other_member(state, *drawn)
    return _put(f"reuse a free number for {other[0]}", drawn[0].id, other[1], over=False) if drawn and other else None


def replace_member(draft: Draft, state: State) -> Change | None:
    """Give a number from one commit to the next to a member with another meaning."""
    drawn = _drawn_member(draft, state)
    other = drawn and draft.other_member(state, *drawn)
    return _put(f"replace a member by {other[0]}", drawn[0].id, other[1], over=True) if drawn and other else None


def rename_member(draft: Draft, state: State) -> Change | None:
    """Rename a member within its meaning."""
    drawn = _drawn_member(draft, state)
    return drawn and _put("rename a member", drawn[0].id, draft.renamed(*drawn), over=True)


def rename_member_in_doubt(draft: Draft, state: State) -> Change | None:
    """Rename speed to velocity, or back."""
    fields = [
        (one, member, member.meaning)
        for one in state.types.values()
        for member in one.members.values()
        if isinstance(member.meaning, Meaning) and member.meaning.doubtful
    ]
    if not fields:
        return None
    one, member, meaning = draft.random.choice(fields)
    doubtful = replace(member, meaning=meaning.in_doubt(), name=meaning.in_doubt().field_names()[0])
    return _put("rename speed to velocity", one.id, doubtful, over=True)


def widen_member(draft: Draft, state: State) -> Change | None:
    """Change the type to one that reads the same bytes."""
    drawn = _drawn_scalar(draft, state)
    if drawn is None or drawn[1].type not in _WIDER:
        return None
    return _put("widen a type", drawn[0].id, replace(drawn[1], type=_WIDER[str(drawn[1].type)]), over=True)


def retype_member(draft: Draft, state: State) -> Change | None:
    """Change the type to one that reads other bytes, under the same name."""
    drawn = _drawn_scalar(draft, state)
    if drawn is None or drawn[1].type == "string":
        return None
    return _put("change a type", drawn[0].id, replace(drawn[1], type="string"), over=True)


def repeat_member(draft: Draft, state: State) -> Change | None:
    """Make a list of one value, or one value of a list."""
    drawn = _drawn_scalar(draft, state)
    kind = "change between one value and a list"
    return drawn and _put(kind, drawn[0].id, replace(drawn[1], repeated=not drawn[1].repeated), over=True)


def swap_members(draft: Draft, state: State) -> Change | None:
    """Exchange the numbers of two members."""
    one = _drawn_type(draft, state)
    members = _replaceable(one)
    if len(members) < 2:
        return None
    first, second = draft.random.sample(members, 2)

    def swap(one: Type) -> Type | None:
        if not {first.number, second.number} <= set(one.members):
            return None
        return one.with_member(replace(first, number=second.number)).with_member(replace(second, number=first.number))

    return _of_type("swap two numbers", one.id, swap)


def renumber_member(draft: Draft, state: State) -> Change | None:
    """Give a member a number that the type never had."""
    drawn = _drawn_member(draft, state)
    if drawn is None:
        return None
    (one, member), number = drawn, draft.next_number(drawn[0])
    return _of_type(
        "renumber a member",
        one.id,
        lambda one: (
            one.without(member.number).with_member(replace(member, number=number))
            if one.members.get(member.number) == member
            else None
        ),
    )


# --- changes of types --------------------------------------------------------------------------------------------


def _new_name(draft: Draft, one: Type) -> str:
    return f"{one.name}{draft.random.choice(['Data', 'Message'])}" if draft.random.random() < 0.4 else draft.names.pop()


def rename_type(draft: Draft, state: State) -> Change | None:
    """Rename a message or an enum that has members by which one recognizes it."""
    one = _drawn_type(draft, state)
    if len(_replaceable(one)) < 2:
        return None
    name = _new_name(draft, one)
    return _of_type(f"rename {_sort(one)}", one.id, lambda one: replace(one, name=name))


def rename_type_and_reuse(draft: Draft, state: State) -> Change | None:
    """Rename a type of many members and give one of its numbers away in the same commit."""
    one = _drawn_type(draft, state)
    if len(_replaceable(one)) < 4:
        return None
    name, member = _new_name(draft, one), draft.random.choice(_replaceable(one))
    drawn = draft.other_member(state, one, member)
    if drawn is None:
        return None
    kind = f"rename {_sort(one)} and replace a member by {drawn[0]}"
    return _of_type(
        kind, one.id, lambda one: replace(one, name=name).with_member(drawn[1]) if len(one.members) > 3 else None
    )


def _sort(one: Type) -> str:
    return "the envelope" if one.is_envelope else "a message" if one.keyword == "message" else "an enum"


def nest_type(draft: Draft, state: State) -> Change | None:
    """Move a type into a message of the same file."""
    tops = state.inside(None)
    inner, outer = draft.random.choice(tops), draft.random.choice(tops)
    if (
        inner is outer
        or inner.file != outer.file
        or inner.is_envelope
        or outer.is_envelope
        or outer.keyword == "enum"
        or state.inside(inner.id)
        or len(_replaceable(inner)) < 2
    ):
        return None
    return _of_type("nest a type", inner.id, lambda one: replace(one, outer=outer.id))


def unnest_type(draft: Draft, state: State) -> Change | None:
    """Move a nested type to the top level."""
    nested = [one for one in state.types.values() if one.outer is not None and len(_replaceable(one)) > 1]
    if not nested:
        return None
    return _of_type("un-nest a type", draft.random.choice(nested).id, lambda one: replace(one, outer=None))


def add_type(draft: Draft, state: State) -> Change | None:
    """Add a message or an enum at the top level."""
    file = draft.random.choice(list(state.files))
    one = draft.new_type(draft.random.choice(["message", "message", "enum"]), file, draft.names.pop())
    return Change("add a type", lambda state: state.with_type(one) if file in state.files else None)


def add_nested_type(draft: Draft, state: State) -> Change | None:
    """Add a nested type with a name that other messages have inside too, and a field of an enum."""
    outers = [one for one in state.inside(None) if one.keyword == "message" and not one.is_envelope]
    if not outers:
        return None
    outer = draft.random.choice(outers)
    one = draft.new_type(
        draft.random.choice(["message", "enum"]), outer.file, draft.random.choice(_NESTED_NAMES), outer.id
    )
    number = draft.next_number(outer)
    member = Member(number, one.name.lower(), one.id, Meaning("its", one.name))

    def add(state: State) -> State | None:
        around = state.types.get(outer.id)
        if around is None or around.file != one.file or number in around.members:
            return None
        return state.with_type(around.with_member(member) if one.keyword == "enum" else around, one)

    return Change("add a nested type", add)


def delete_type(draft: Draft, state: State) -> Change | None:
    """Delete a type that nothing uses, with the types in it."""
    unused = [one for one in state.types.values() if not one.is_envelope and not state.users(one.id)]
    if len(unused) < 2:
        return None
    id = draft.random.choice(unused).id
    return Change("delete a type", lambda state: state.without_type(id) if id in state.types else None)


def restore_type(draft: Draft, state: State) -> Change | None:
    """Declare a deleted type again, as it was."""
    gone = [id for id in draft.last_types if id not in state.types]
    if not gone:
        return None
    types = draft.last_types[draft.random.choice(gone)]
    return Change("restore a type", lambda state: None if types[0].id in state.types else state.with_type(*types))


def replace_nested_type(draft: Draft, state: State) -> Change | None:
    """Delete a nested type, and add another one of the same last name to another message in the same commit."""
    nested = [one for one in state.types.values() if one.outer is not None and not state.users(one.id)]
    outers = [one for one in state.inside(None) if one.keyword == "message" and not one.is_envelope]
    if not nested or not outers:
        return None
    old, outer = draft.random.choice(nested), draft.random.choice(outers)
    one = draft.new_type(old.keyword, outer.file, old.name, outer.id)
    kind = "replace a nested type by another of its last name"
    return Change(kind, lambda state: state.without_type(old.id).with_type(one) if old.id in state.types else None)


# --- changes of files --------------------------------------------------------------------------------------------


def _of_file(kind: str, id: int, change: Callable[[File], File]) -> Change:
    return Change(kind, lambda state: state.with_file(id, change(state.files[id])) if id in state.files else None)


def move_file(draft: Draft, state: State) -> Change | None:
    """Move a file to another folder, under its name or another one."""
    id = draft.random.choice(list(state.files))
    name = state.files[id].path.rpartition("/")[2]
    path = draft.random.choice(_FOLDERS) + draft.random.choice([name, f"{draft.names.pop().lower()}.proto"])
    return _of_file("move a file", id, lambda file: replace(file, path=path))


def change_package(draft: Draft, state: State) -> Change | None:
    """Give a file another package, or its first one, or none."""
    id = draft.random.choice(list(state.files))
    if _is_vendored(state, id) or any(len(_replaceable(one)) < 2 for one in state.types.values() if one.file == id):
        return None
    package = draft.random.choice(_PACKAGES)
    return _of_file("change a package", id, lambda file: replace(file, package=package))


def move_type(draft: Draft, state: State) -> Change | None:
    """Move a type with the types in it to another file."""
    one, file = draft.random.choice(state.inside(None)), draft.random.choice(list(state.files))
    if len(_replaceable(one)) < 2 or one.is_envelope or _is_vendored(state, one.file) or _is_vendored(state, file):
        return None

    def move(state: State) -> State | None:
        moved = [replace(each, file=file) for each in state.types.values() if one.id in (each.id, each.outer)]
        return state.with_type(*moved) if moved and file in state.files else None

    return Change("move a type to another file", move)


def vendor_copy(draft: Draft, state: State) -> Change | None:
    """Copy a file with all its types into a package of its own."""
    file = draft.random.choice(list(state.files))
    types = [one for one in state.types.values() if one.file == file]
    if not types or any(one.is_envelope or _uses_types(one) for one in types) or _is_vendored(state, file):
        return None
    copy = draft.new_id()
    ids = {one.id: draft.new_id() for one in types}
    copies = [
        replace(one, id=ids[one.id], file=copy, outer=None if one.outer is None else ids[one.outer]) for one in types
    ]
    path = f"vendor/{state.files[file].path}"
    return Change(
        "add a vendored copy",
        lambda state: None if copy in state.files else state.with_file(copy, File(path, "vendor")).with_type(*copies),
    )


def copy_outside_the_root(draft: Draft, state: State) -> Change | None:
    """Put an edition of a file with other meanings outside the proto root."""
    one = _drawn_type(draft, state)
    edited = one
    for member in _replaceable(one):
        drawn = draft.other_member(state, edited, member)
        edited = edited.with_member(drawn[1]) if drawn else edited
    path = f"{state.root}/{state.files[one.file].path}"
    text = state.with_type(edited).texts()[path]
    other = f"third_party/{draft.names.pop().lower()}/{state.files[one.file].path}"
    return Change("add a copy outside the root", lambda state: replace(state, others={**state.others, other: text}))


def _uses_types(one: Type) -> bool:
    return any(isinstance(member.type, int) for member in one.members.values())


def move_into_the_root(draft: Draft, state: State) -> Change | None:
    """Move all files from elsewhere in the repository into the proto root."""
    return Change("move into the root", lambda state: replace(state, root="protos")) if state.root == "api" else None


# How often each change is drawn.
WEIGHTS: dict[Callable[[Draft, State], Change | None], int] = {
    add_member: 8,
    delete_member: 20,
    restore_member: 8,
    reuse_free_number: 24,
    replace_member: 6,
    rename_member: 8,
    rename_member_in_doubt: 2,
    widen_member: 4,
    retype_member: 2,
    repeat_member: 2,
    swap_members: 2,
    renumber_member: 4,
    rename_type: 9,
    rename_type_and_reuse: 3,
    nest_type: 6,
    unnest_type: 5,
    add_type: 3,
    add_nested_type: 5,
    delete_type: 5,
    restore_type: 3,
    replace_nested_type: 4,
    move_file: 6,
    change_package: 6,
    move_type: 4,
    vendor_copy: 3,
    copy_outside_the_root: 2,
    move_into_the_root: 6,
}
