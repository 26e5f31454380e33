"""Envelope numbers in other projects, the consumers: each project uses (pins) one commit of the .proto files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.git import Commit, GitError, Repository, name_of_repository
from roverlink.generator.lint.consumer_pins import Pin
from roverlink.generator.lint.history import differ
from roverlink.generator.lint.input_rules import UNREADABLE_PINS
from roverlink.generator.protos.parser import parse

_FETCH = "run `git fetch --all` to get new commits, or correct the pin"


@dataclass(frozen=True, slots=True)
class Pinned:
    """A project that uses the .proto files, the commit that it uses, and the envelope's numbers at that commit."""

    pin: Pin
    commit: Commit
    numbers: Mapping[int, tuple[str, str]]
    """Type and name of each payload by number, such as ``{3: ("ImuInfo", "imu_info")}``."""

    def disagreements(self, other: Pinned) -> list[int]:
        """Return the envelope numbers that have different payloads in this project's commit and in the other's commit.

        Each commit is the one of the .proto files that the project uses.
        """
        return sorted(
            number
            for number in self.numbers.keys() & other.numbers.keys()
            if differ(self.numbers[number], other.numbers[number])
        )


def read_pinned(pins: Sequence[Pin], repository: Repository, envelope: str, findings: list[Diagnostic]) -> list[Pinned]:
    """Read the envelope's numbers at the commit of each pin.

    The file or repository with the pins may also pin other repositories. So an unknown commit is only reported if the
    pin comes from a list of pins, or if its address is that of this repository. A file or repository without any known
    commit is reported as well.
    """
    pinned: list[Pinned] = []
    faults: list[Diagnostic] = []
    ours = repository.names() if pins else set()
    for pin in pins:
        try:
            pinned.append(_pinned(pin, repository, envelope))
        except LookupError as error:
            if pin.listed or name_of_repository(pin.address) in ours:
                message = f"the project {pin.consumer!r} is pinned to {pin.commit!r}, which {error.args[0]}"
                faults.append(UNREADABLE_PINS.at(pin.span, message, _FETCH))
    findings += faults
    if not faults:
        findings += _without_any(pins, {one.pin.source for one in pinned})
    return pinned


def _pinned(pin: Pin, repository: Repository, envelope: str) -> Pinned:
    """Return the envelope's numbers at the commit of a pin.

    Raises `LookupError` if the repository does not contain the commit, if a file of the commit cannot be read, or if
    the commit does not declare the envelope.
    """
    try:
        commit = repository.commit(pin.commit)
        numbers = _numbers_at(repository, commit.id, envelope)
    except GitError as error:
        raise LookupError("this repository does not have") from error
    if numbers is None:
        raise LookupError(f"has no message {envelope!r}")
    return Pinned(pin, commit, numbers)


def _without_any(pins: Sequence[Pin], known: Set[str]) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each source of pins (a file or repository) without any commit of this repository.

    ``known`` are the sources that have such a commit.
    """
    for source in dict.fromkeys(pin.source for pin in pins if pin.source not in known):
        others = ", ".join(f"{pin.consumer} ({pin.commit})" for pin in pins if pin.source == source)
        message = f"none of the pins here is a commit of this repository: {others}"
        yield UNREADABLE_PINS.at(Span(source), message, _FETCH)


def _numbers_at(repository: Repository, commit: str, envelope: str) -> dict[int, tuple[str, str]] | None:
    """Return type and name of each payload by number, at a commit; None if the commit does not declare the envelope.

    If no message has the full name ``envelope``, a message of the same name in another package is used. Raises
    `LookupError` if a .proto file cannot be read.
    """
    name = envelope.rpartition(".")[2]
    found: dict[str, dict[int, tuple[str, str]]] = {}
    for file, data in repository.contents(commit, lambda path: path.endswith(".proto")):
        if isinstance(data, str):
            why = f"has a file that cannot be read, {file!r}: {data}"
            raise LookupError(why)  # noqa: TRY004  # the repository's fault, not a caller's
        # A file without the envelope's name cannot declare it, and need not be parsed.
        if name.encode() in data:
            for message in parse(data.decode("utf-8", errors="replace")).messages:
                if message.name == name:
                    numbers = found.setdefault(message.full_name, {})
                    numbers |= {field.number: (field.type, field.name) for field in message.fields}
    return found.get(envelope) or next(iter(found.values()), None)
