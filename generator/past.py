"""What a lint knows of the past: all of history, and the commits that consumers of the protos are pinned to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from generator.declarations import parse
from generator.findings import Finding
from generator.git import Commit, GitError, Repository
from generator.history import History
from generator.pins import UNREADABLE_PINS, Pin


@dataclass(frozen=True, slots=True)
class Pinned:
    """What a consumer's commit says of the envelope."""

    pin: Pin
    commit: Commit
    numbers: Mapping[int, tuple[str, str]]
    """Type and name of the payload by its number."""

    def disagreements(self, other: Pinned) -> list[int]:
        """The numbers that are of another payload to another consumer."""
        return sorted(
            number
            for number in self.numbers.keys() & other.numbers.keys()
            if self.numbers[number][0] != other.numbers[number][0]
        )


@dataclass(frozen=True, slots=True)
class Past:
    """The history of the protos, and what of it is looked at."""

    history: History
    of_numbers: bool = False
    """Whether every number's past is judged."""
    of_branches: bool = False
    """Whether open branches are compared with each other."""
    pinned: tuple[Pinned, ...] = ()
    """The consumers, and what the commits that they are pinned to say."""

    def taken(self, envelope: str) -> dict[int, str]:
        """Every number that the envelope ever had on any branch, and what for."""
        taken: dict[int, str] = {}
        for number, lives in self.history.claims(envelope).items():
            taken[number] = f"stood in a comment, for {lives[-1].name} ({lives[-1].came})"
        for number, lives in self.history.numbers(envelope).items():
            last = lives[-1]
            where = f", which {_branch(last.live_at[0])} has" if last.live_at else f" until {last.went}"
            taken[number] = f"stood for {last.name} ({last.type}){where}"
        return taken


def _branch(ref: str) -> str:
    return ref.removeprefix("refs/heads/").removeprefix("refs/remotes/")


def read_pinned(
    pins: Iterable[Pin], repository: Repository, envelope: str, findings: list[Finding]
) -> Iterator[Pinned]:
    """What each pin's commit of the protos says of the envelope.

    A commit that this repository does not have is a finding where a plain list names it; of other sources, it is that
    of another dependency.
    """
    for pin in pins:
        try:
            commit = repository.commit(pin.commit)
            numbers = _numbers_at(repository, commit.id, envelope)
        except GitError as error:
            if pin.listed:
                message = f"{pin.consumer} is pinned to {pin.commit}, which this repository does not have"
                findings.append(UNREADABLE_PINS.at(pin.span, message, str(error)))
        else:
            yield Pinned(pin, commit, numbers)


def _numbers_at(repository: Repository, commit: str, envelope: str) -> dict[int, tuple[str, str]]:
    name = envelope.rpartition(".")[2]
    protos = [file for file in repository.files(commit) if file.endswith(".proto")]
    found: dict[int, tuple[str, str]] = {}
    for _, data in repository.contents(commit, protos):
        if name.encode() in data:
            for message in parse(data.decode("utf-8", errors="replace")).all_messages():
                if message.full_name == envelope:
                    found |= {field.number: (field.type, field.name) for field in message.fields if field.number}
    return found
