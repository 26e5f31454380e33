"""Histories made up at random, of which it is known for each number whether it ever had two meanings.

What only an open branch has done does not count, unless main has one of the meanings today and the branch the other.

A history is a function of its seed. It has branches, merges, reverts and cherry-picks, and sometimes a last change that
is staged, or only written to the working tree. To look into one, run this module with the seed and a new folder:
it writes the repository, and prints its log and the truth.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

from proto_model import File, Member, State, Type, Use, merged
from random_changes import WEIGHTS, Change, Draft
from random_names import Meaning
from repositories import RepositoryBuilder, git

Key = tuple[int, int]  # id of a type, and a number

_STAGED = "only staged"
_MAIN = "main"


@dataclass
class Truth:
    """The uses of each number at all commits, and the changes that touched it."""

    ids: dict[str, int] = field(default_factory=dict)  # of types, by each full name that they ever had
    _uses: dict[Key, set[Use]] = field(default_factory=lambda: defaultdict(set))
    _guilty: dict[Key, tuple[str, str]] = field(default_factory=dict)  # what brought the second meaning, and how
    _touched: dict[Key, tuple[str, str]] = field(default_factory=dict)  # the latest change of the member
    _moved: dict[int, set[str]] = field(default_factory=lambda: defaultdict(set))
    _of_branch: dict[str, dict[Key, set[Use]]] = field(default_factory=lambda: defaultdict(lambda: defaultdict(set)))
    _standing: set[Key] = field(default_factory=set)  # main has one meaning today, and an open branch the other

    def record(self, before: State, after: State, kind: str, how: str, branch: str = _MAIN) -> None:
        """Take note of a state, of the change that led to it, how that was committed, and on which branch."""
        self.ids |= {name: id for id, name in after.names().items()}
        for id, one in after.types.items():
            if id in before.types and _place(before, id) != _place(after, id):
                self._moved[id].add(kind)
            for number, member in one.members.items():
                if id not in before.types or before.types[id].members.get(number) != member:
                    self._use((id, number), member, (kind, how))
                    self._of_branch[branch][id, number].add(member.use)

    def merge(self, branch: str) -> None:
        """Take note that a branch was merged into main."""
        for key, uses in self._of_branch.pop(branch, {}).items():
            self._of_branch[_MAIN][key] |= uses

    def end(self, main: State, others: Iterable[State]) -> None:
        """Take note of the last states of main and of the open branches."""
        for other in others:
            for id in main.types.keys() & other.types.keys():
                ours, theirs = main.types[id].members, other.types[id].members
                for number in ours.keys() & theirs.keys():
                    if _is_reused({ours[number].use, theirs[number].use}):
                        self._standing.add((id, number))

    def _use(self, key: Key, member: Member, change: tuple[str, str]) -> None:
        was_reused = key in self._guilty
        self._touched[key] = change
        self._uses[key].add(member.use)
        if not was_reused and _is_reused(self._uses[key]):
            self._guilty[key] = change

    @property
    def reused(self) -> set[Key]:
        """Numbers that had two meanings, or two formats on the wire, on main or today on main and an open branch."""
        kept = {key for key, uses in self._of_branch[_MAIN].items() if _is_reused(uses)}
        return self._guilty.keys() & (kept | self._standing)

    @property
    def doubtful(self) -> set[Key]:
        """Numbers of which people may think one or the other."""
        return {key for key, uses in self._uses.items() if len(uses) > 1} - self._guilty.keys()

    def causes(self, key: Key) -> list[str]:
        """Name what made the verdict on a number difficult: changes of the number, how they came, and of its type.

        The change of a number is the one that brought the second meaning, or the latest one if there is no second.
        """
        kind, how = self._guilty.get(key) or self._touched.get(key) or ("a number that the type never had", "")
        moves = self._moved[key[0]] or {"as it was"}
        return [f"number: {kind}", f"commit: {how or 'an ordinary one'}", *sorted(f"type: {move}" for move in moves)]


def _is_reused(uses: set[Use]) -> bool:
    return len({(_certain(meaning), *wire) for meaning, *wire in uses}) > 1


def _certain(meaning: Meaning | int) -> Meaning | int:
    """Return the meaning; speed and velocity are one."""
    return replace(meaning, quantity="speed") if isinstance(meaning, Meaning) and meaning.doubtful else meaning


def _place(state: State, id: int) -> tuple[str, str, str]:
    return state.full_name(id), state.root, state.files[state.types[id].file].path


@dataclass
class _Branch:
    """A branch: its last commit, and the changes since it began, each with the state before it."""

    mark: int
    state: State
    base: State
    changes: list[tuple[Change, State]] = field(default_factory=list)


class RandomHistory:
    """The history of a seed."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.truth = Truth()
        self._random = Random(seed)  # noqa: S311  # a draw, no secret
        self._draft = Draft.of(self._random)
        self._repository = RepositoryBuilder(folder)
        self._has_envelope = self._random.random() < 0.6
        first = self._first_state()
        mark = self._repository.commit("begin", first.texts())
        self.truth.record(State("", {}, {}), first, "begin", "")
        self._draft.remember(first)
        self._branches = {"main": _Branch(mark, first, first)}
        for _ in range(self._random.randint(12, 30)):
            self._step()
        if self._main.state.root == "api":
            self._commit("main", replace(self._main.state, root="protos"), "move into the root")
        self._uncommitted = self._last_change() if self._random.random() < 0.25 else None
        newest = self._uncommitted[1] if self._uncommitted else self._main.state
        self.truth.end(newest, [one.state for name, one in self._branches.items() if name != _MAIN])

    @property
    def _main(self) -> _Branch:
        return self._branches["main"]

    @property
    def command(self) -> list[str]:
        """Arguments of `roverlink` that judge the history."""
        tree = ["lint", "--history", str(self._repository.root / "protos")]
        now = self._uncommitted[1] if self._uncommitted else self._main.state
        envelopes = [now.full_name(id) for id, one in now.types.items() if one.is_envelope]
        return [*tree, "--message", *envelopes] if envelopes else tree

    def write(self) -> None:
        """Write the repository, with its working tree and index."""
        root = self._repository.write()
        git(root, "checkout", "--quiet", "--force", "main")
        if self._uncommitted is None:
            return
        before, after = self._main.state.texts(), self._uncommitted[1].texts()
        for path in before.keys() - after.keys():
            (root / path).unlink()
        for path, text in after.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text)
        if self._uncommitted[0] == _STAGED:
            git(root, "add", "--all")

    def _first_state(self) -> State:
        draft, random = self._draft, self._random
        files = {
            draft.new_id(): File(f"{draft.names.pop().lower()}.proto", random.choice(["", "", "rover"]))
            for _ in range(random.randint(1, 3))
        }
        state = State("api" if random.random() < 0.15 else "protos", files, {})
        for _ in range(random.randint(2, 5)):
            file, keyword = random.choice(list(files)), random.choice(["message", "message", "message", "enum"])
            state = state.with_type(draft.new_type(keyword, file, draft.names.pop()))
        return self._with_envelope(state) if self._has_envelope else state

    def _with_envelope(self, state: State) -> State:
        """Add an envelope of four payloads, among the messages two without fields."""
        draft, file, first = self._draft, self._draft.new_id(), next(iter(state.files))
        empty = [Type(draft.new_id(), "message", draft.names.pop(), first) for _ in range(2)]
        state = state.with_type(*empty).with_file(file, File("envelope.proto", ""))
        one = Type(draft.new_id(), "message", "PBEnvelope", file, is_envelope=True)
        for number in range(1, 5):
            if member := draft.new_member(state, one, number):
                one = one.with_member(member)
                draft.meanings.setdefault(one.id, set()).add(member.meaning)
        return state.with_type(one)

    # --- steps ---

    def _step(self) -> None:
        name = self._random.choice(sorted(self._branches)) if self._random.random() < 0.4 else "main"
        dice = self._random.random()
        if dice < 0.10 and len(self._branches) < 3:
            self._begin_branch()
        elif dice < 0.20 and name != "main":
            self._merge(name)
        elif dice < 0.28:
            self._revert(name)
        elif dice < 0.36:
            self._pick(name)
        else:
            self._change(name)

    def _begin_branch(self) -> None:
        name = f"branch_{self._draft.new_id()}"
        self._repository.branch(name, self._main.mark)
        self._branches[name] = _Branch(self._main.mark, self._main.state, self._main.state)

    def _change(self, name: str) -> None:
        branch = self._branches[name]
        if drawn := self._drawn(branch.state):
            change, after = drawn
            branch.changes.append((change, branch.state))
            self._commit(name, after, change.kind)

    def _revert(self, name: str) -> None:
        branch = self._branches[name]
        if branch.changes:
            change, before = branch.changes.pop()
            if change.apply(before) == branch.state:
                self._commit(name, before, change.kind, "a revert")

    def _pick(self, name: str) -> None:
        branch = self._branches[name]
        theirs = [change for other in self._branches.values() if other is not branch for change, _ in other.changes]
        change = self._random.choice(theirs) if theirs else None
        after = self._accepted(branch.state, change) if change else None
        if change and after:
            self._commit(name, after, change.kind, "a cherry-pick")

    def _merge(self, name: str) -> None:
        """Merge a branch into main; where nothing sound comes out, main stays as it is, as with `-s ours`."""
        ours, theirs = self._main, self._branches.pop(name)
        found = merged(theirs.base, ours.state, theirs.state)
        after = found if self._is_sound(found) else ours.state
        self._commit("main", after, "merge", "a merge", parents=[ours.mark, theirs.mark])
        self.truth.merge(name)
        ours.changes.clear()
        if self._random.random() < 0.5:
            self._repository.delete_branch(name)

    def _last_change(self) -> tuple[str, State] | None:
        """Draw a change that is not committed: how far it came, and the state."""
        drawn = self._drawn(self._main.state)
        if drawn is None:
            return None
        change, after = drawn
        how = self._random.choice([_STAGED, "only written"])
        self.truth.record(self._main.state, after, change.kind, how)
        return how, after

    def _drawn(self, state: State) -> tuple[Change, State] | None:
        """Draw changes until one is possible."""
        for draw in self._random.choices(list(WEIGHTS), list(WEIGHTS.values()), k=10):
            change = draw(self._draft, state)
            after = self._accepted(state, change) if change else None
            if change and after:
                return change, after
        return None

    def _accepted(self, state: State, change: Change) -> State | None:
        after = change.apply(state)
        return after if after and after != state and self._is_sound(after) else None

    def _is_sound(self, state: State) -> bool:
        """False if protoc rejects the state, or if it gives a name to a second type."""
        return state.compiles() and all(self.truth.ids.get(name, id) == id for id, name in state.names().items())

    def _commit(self, name: str, after: State, kind: str, how: str = "", parents: list[int] | None = None) -> None:
        branch = self._branches[name]
        old, new = branch.state.texts(), after.texts()
        files: dict[str, str | None] = {path: text for path, text in new.items() if old.get(path) != text}
        files |= dict.fromkeys(old.keys() - new.keys())
        branch.mark = self._repository.commit(f"{kind} ({how})" if how else kind, files, branch=name, parents=parents)
        self.truth.record(branch.state, after, kind, how, name)
        self._draft.remember(after)
        branch.state = after


def main(seed: str, folder: str) -> None:
    """Write the history of a seed into a folder, and print its log and the truth."""
    history = RandomHistory(int(seed), Path(folder))
    history.write()
    print(git(Path(folder), "log", "--all", "--graph", "--oneline"), git(Path(folder), "status", "--short"))
    names = {id: name for name, id in history.truth.ids.items()}
    for sort, keys in (("two meanings", history.truth.reused), ("doubtful", history.truth.doubtful)):
        print(f"{sort}:", *sorted(f"{names[id]} {number}" for id, number in keys), sep="\n  ")
    print("roverlink", *history.command)


if __name__ == "__main__":
    main(*sys.argv[1:])
