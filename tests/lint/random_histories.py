"""Histories made up at random, of which it is known for each number whether it ever had two meanings.

What only an open branch has done does not count, unless main has one of the meanings today and the branch the other.

A history is a function of its seed. It has branches, merges, reverts and cherry-picks, and sometimes a last change that
is staged, or only written to the working tree.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

from random_trees import Changes, State, Type, Use, merged
from repositories import RepositoryBuilder, git

Key = tuple[int, int]  # id of a type, and a number
_MAIN = "main"


@dataclass
class Truth:
    """The uses of each number at all commits."""

    ids: dict[str, int] = field(default_factory=dict)  # of types, by each full name that they ever had
    _of_branch: defaultdict[str, defaultdict[Key, set[Use]]] = field(
        default_factory=lambda: defaultdict(lambda: defaultdict(set))
    )
    _standing: set[Key] = field(default_factory=set)  # main has one meaning today, and an open branch the other

    def record(self, before: State, after: State, branch: str = _MAIN) -> None:
        """Take note of what a commit on a branch brought."""
        self.ids |= {after.full_name(id): id for id in after.types}
        for id, one in after.types.items():
            for number, member in one.members.items():
                if id not in before.types or before.types[id].members.get(number) != member:
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
                both = ours.keys() & theirs.keys()
                self._standing |= {(id, number) for number in both if ours[number].use != theirs[number].use}

    @property
    def reused(self) -> set[Key]:
        """Numbers that had two meanings, or two formats on the wire, on main or today on main and an open branch."""
        return {key for key, uses in self._of_branch[_MAIN].items() if len(uses) > 1} | self._standing


@dataclass
class _Branch:
    """A branch: its last commit, and the changes since it began, each with the states before and after it."""

    mark: int
    state: State
    base: State
    changes: list[tuple[State, State]] = field(default_factory=list)


class RandomHistory:
    """The history of a seed."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.truth = Truth()
        self._random = Random(seed)  # noqa: S311  # a draw, no secret
        self._changes = Changes(self._random)
        self._repository = RepositoryBuilder(folder)
        first = self._first_state()
        self._main = _Branch(self._repository.commit("begin", first.texts()), first, first)
        self._branches = {_MAIN: self._main}
        self.truth.record(State("", {}, {}), first)
        self._changes.remember(first)
        for _ in range(self._random.randint(12, 30)):
            self._step()
        if self._main.state.root == "api":
            self._commit(_MAIN, replace(self._main.state, root="protos"), "move into the root")
        drawn = self._drawn(self._main.state) if self._random.random() < 0.25 else None
        self._newest = drawn[1] if drawn else self._main.state
        self._staged = self._random.random() < 0.5
        self.truth.record(self._main.state, self._newest)
        self.truth.end(self._newest, [one.state for name, one in self._branches.items() if name != _MAIN])

    @property
    def command(self) -> list[str]:
        """Arguments of `roverlink` that judge the history."""
        tree = ["lint", "--history", str(self._repository.root / "protos")]
        envelopes = [self._newest.full_name(id) for id, one in self._newest.types.items() if one.is_envelope]
        return [*tree, "--message", *envelopes] if envelopes else tree

    def write(self) -> None:
        """Write the repository, with its working tree and index."""
        root = self._repository.write()
        git(root, "checkout", "--quiet", "--force", "main")
        before, after = self._main.state.texts(), self._newest.texts()
        for path in before.keys() - after.keys():
            (root / path).unlink()
        for path, text in after.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text)
        if self._staged:
            git(root, "add", "--all")

    def _first_state(self) -> State:
        changes, random = self._changes, self._random
        files = {
            next(changes.ids): (f"{changes.new_name().lower()}.proto", random.choice(["", "", "rover"]))
            for _ in range(random.randint(1, 3))
        }
        state = State("api" if random.random() < 0.15 else "protos", files, {})
        for _ in range(random.randint(2, 5)):
            file, keyword = random.choice(list(files)), random.choice(["message", "message", "message", "enum"])
            state = state.put(changes.new_type(keyword, file, changes.new_name()))
        return self._with_envelope(state) if random.random() < 0.6 else state

    def _with_envelope(self, state: State) -> State:
        """Add an envelope of four payloads, among the messages two without fields."""
        changes, file, first = self._changes, next(self._changes.ids), next(iter(state.files))
        empty = [Type(next(changes.ids), "message", changes.new_name(), first) for _ in range(2)]
        state = state.put(*empty).with_file(file, "envelope.proto", "")
        one = Type(next(changes.ids), "message", "PBEnvelope", file, is_envelope=True)
        members = [changes.new_member(state, one, number) for number in range(1, 5)]
        return state.put(one.with_member(*(member for member in members if member)))

    # --- steps ---

    def _step(self) -> None:
        name = self._random.choice(sorted(self._branches)) if self._random.random() < 0.4 else _MAIN
        branch, dice = self._branches[name], self._random.random()
        if dice < 0.10 and len(self._branches) < 3:
            new = f"branch_{next(self._changes.ids)}"
            self._repository.branch(new, self._main.mark)
            self._branches[new] = _Branch(self._main.mark, self._main.state, self._main.state)
        elif dice < 0.20 and name != _MAIN:
            self._merge(name)
        elif dice < 0.28 and branch.changes:
            before, after = branch.changes.pop()
            self._take_over(name, after, before, "revert")
        elif dice < 0.36:
            others = [pair for other in self._branches.values() if other is not branch for pair in other.changes]
            if others:
                self._take_over(name, *self._random.choice(others), "cherry-pick")
        elif drawn := self._drawn(branch.state):
            branch.changes.append((branch.state, drawn[1]))
            self._commit(name, drawn[1], drawn[0])

    def _take_over(self, name: str, before: State, after: State, how: str) -> None:
        """Apply to a branch what changes one state into another, if something sound comes out."""
        state = self._branches[name].state
        found = merged(before, state, after)
        if found != state and self._is_sound(found):
            self._commit(name, found, how)

    def _merge(self, name: str) -> None:
        """Merge a branch into main; where nothing sound comes out, main stays as it is, as with `-s ours`."""
        ours, theirs = self._main, self._branches.pop(name)
        found = merged(theirs.base, ours.state, theirs.state)
        after = found if self._is_sound(found) else ours.state
        self._commit(_MAIN, after, "merge", parents=[ours.mark, theirs.mark])
        self.truth.merge(name)
        ours.changes.clear()
        if self._random.random() < 0.5:
            self._repository.delete_branch(name)

    def _drawn(self, state: State) -> tuple[str, State] | None:
        """Draw changes until one is possible."""
        drawn = (self._changes.draw(state) for _ in range(10))
        return next((one for one in drawn if one and self._is_sound(one[1])), None)

    def _is_sound(self, state: State) -> bool:
        """False if protoc rejects the state, or if it gives a name to a second type."""
        return state.compiles() and all(self.truth.ids.get(state.full_name(id), id) == id for id in state.types)

    def _commit(self, name: str, after: State, subject: str, parents: list[int] | None = None) -> None:
        branch = self._branches[name]
        old, new = branch.state.texts(), after.texts()
        files: dict[str, str | None] = {path: text for path, text in new.items() if old.get(path) != text}
        files |= dict.fromkeys(old.keys() - new.keys())
        branch.mark = self._repository.commit(subject, files, branch=name, parents=parents)
        self.truth.record(branch.state, after, name)
        self._changes.remember(after)
        branch.state = after
