"""The numbers of the envelope at the commits that consumers of the protos are pinned to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.git import Commit, GitError, Repository, name_of_repository
from roverlink.generator.lint.consumer_pins import Pin
from roverlink.generator.lint.history import differ
from roverlink.generator.lint.input_rules import UNREADABLE_PINS
from roverlink.generator.protos.parser import parse

_FETCH = "git fetch --all gets what is new"


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
            if differ(self.numbers[number], other.numbers[number])
        )


def read_pinned(pins: Sequence[Pin], repository: Repository, envelope: str, findings: list[Diagnostic]) -> list[Pinned]:
    """What each pin's commit of the protos says of the envelope.

    A commit that this repository does not have is a finding where a plain list names it, or where the pin is by its
    address one of this repository; of other addresses, it is that of another dependency. So is a source of which
    nothing is known here.
    """
    pinned: list[Pinned] = []
    faults: list[Diagnostic] = []
    ours = repository.called() if pins else set()
    for pin in pins:
        try:
            pinned.append(_pinned(pin, repository, envelope))
        except LookupError as error:
            if pin.listed or name_of_repository(pin.address) in ours:
                message = f"{pin.consumer} is pinned to {pin.commit}, which {error.args[0]}"
                faults.append(UNREADABLE_PINS.at(pin.span, message, _FETCH))
    findings += faults
    if not faults:
        findings += _without_any(pins, {one.pin.source for one in pinned})
    return pinned


def _pinned(pin: Pin, repository: Repository, envelope: str) -> Pinned:
    """What a pin's commit says. Raises `LookupError` where this repository does not have it, or it has no envelope."""
    try:
        commit = repository.commit(pin.commit)
        numbers = _numbers_at(repository, commit.id, envelope)
    except GitError as error:
        raise LookupError("this repository does not have") from error
    if numbers is None:
        raise LookupError(f"has no message {envelope}")
    return Pinned(pin, commit, numbers)


def _without_any(pins: Sequence[Pin], known: Set[str]) -> Iterator[Diagnostic]:
    """The sources of which no pin is of this repository."""
    for source in dict.fromkeys(pin.source for pin in pins if pin.source not in known):
        others = ", ".join(f"{pin.consumer} ({pin.commit})" for pin in pins if pin.source == source)
        message = f"none of its pins is a commit of this repository: {others}"
        yield UNREADABLE_PINS.at(Span(source), message, _FETCH)


def _numbers_at(repository: Repository, commit: str, envelope: str) -> dict[int, tuple[str, str]] | None:
    """The envelope's numbers at a commit, in whatever package it was; None where there is none."""
    name = envelope.rpartition(".")[2]
    protos = [file for file in repository.files(commit) if file.endswith(".proto")]
    found: dict[str, dict[int, tuple[str, str]]] = {}
    for _, data in repository.contents(commit, protos):
        if name.encode() in data:
            for message in parse(data.decode("utf-8", errors="replace")).messages:
                if message.name == name:
                    numbers = found.setdefault(message.full_name, {})
                    numbers |= {field.number: (field.type, field.name) for field in message.fields}
    return found.get(envelope) or next(iter(found.values()), None)
