"""States of the protos that other projects, the consumers, use: each project pins one commit of the .proto files.

The states are compared with each other and with the state that is checked, today's checkout. Consumers whose commits
give the same meaning to all bytes share a state.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import combinations

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.git import SUBMODULE, Commit, GitError, Repository, name_of_repository
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.consumer_pins import Pin
from roverlink.generator.lint.git_states import checked_out
from roverlink.generator.lint.input_rules import LimitedHistory, UnreadablePins
from roverlink.generator.lint.misreadings import Misreading, misreadings
from roverlink.generator.protos.files import declarations, proto_files, read_proto
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.protos.uncompiled import with_uncompiled

_FETCH = "run `git fetch --all` to get new commits, or correct the pin"


@dataclass(frozen=True, slots=True)
class Consumer:
    """A project that uses the .proto files, and the commit of them that it uses."""

    pin: Pin
    commit: Commit

    @property
    def name(self) -> str:
        """The name of the project."""
        return self.pin.consumer


@dataclass(frozen=True, slots=True)
class ProtoState:
    """The .proto files that one or several consumers use, or those of the checkout, which the lint checks."""

    schema: Schema
    envelope: str
    """Full name of the envelope's message in this state."""
    consumers: tuple[Consumer, ...] = ()
    checkout: str = ""
    """Name of the checkout, if it has this state: ``this checkout``, or the git ref that is checked; else empty."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the checkout and of the consumers that have this state."""
        return (*filter(None, [self.checkout]), *dict.fromkeys(consumer.name for consumer in self.consumers))


@dataclass(frozen=True, slots=True)
class PinnedStates:
    """The different states of the consumers and of the checkout, the oldest first, compared with each other."""

    states: tuple[ProtoState, ...]
    """The states. Consumers share one if their messages are the same."""
    misreadings: Mapping[tuple[int, int], tuple[Misreading, ...]]
    """The misreadings between each two states, by the indices of the older and of the newer state."""

    def relation(self, one: int, other: int) -> str:
        """Return the relation of two states, by their indices: ``same``, ``compatible``, ``doubtful 1``, ``misread 2``.

        The number counts the fields and enum values.
        """
        if one == other:
            return "same"
        found = self.misreadings[min(one, other), max(one, other)]
        certain = sum(misreading.certain for misreading in found)
        return f"misread {certain}" if certain else f"doubtful {len(found)}" if found else "compatible"


def compare_states(states: Sequence[ProtoState]) -> PinnedStates:
    """Join equal states, and compare each with each other; the states are sorted, the oldest first."""
    joined: dict[Hashable, ProtoState] = {}
    for state in states:
        key = _on_the_wire(state)
        known = joined.get(key)
        if known:
            # A file of the checkout can be edited, so diagnostics show its places.
            shown = state if state.checkout else known
            state = dataclasses.replace(shown, consumers=(*known.consumers, *state.consumers))
        joined[key] = state
    found = tuple(joined.values())
    return PinnedStates(
        found,
        {
            (old, new): misreadings(
                SchemaChange(found[old].schema, found[new].schema), found[old].envelope, found[new].envelope
            )
            for old, new in combinations(range(len(found)), 2)
        },
    )


def _on_the_wire(state: ProtoState) -> Hashable:
    """Return what decides about the meaning of bytes, of all messages and enums that the envelope can contain."""
    schema = state.schema
    messages, enums = schema.reachable(state.envelope)
    fields = [(name, field) for name in messages for field in schema.messages[name].fields]
    fields += [
        (extension.extendee, extension.field) for extension in schema.extensions if extension.extendee in messages
    ]
    return (
        state.envelope,
        frozenset((name, field.fact, *sorted(field.facets.items())) for name, field in fields),
        frozenset((name, *sorted(schema.messages[name].facets.items())) for name in messages),
        frozenset((name, *sorted(value.fact for value in schema.enums[name].values)) for name in enums),
    )


class StateReader:
    """Reader of the states at commits of a repository.

    ``envelopes`` are the names that the envelope's message has or had, today's first. ``exclude`` are the paths of
    files that are never compiled.
    """

    def __init__(self, repository: Repository, envelopes: Sequence[str], exclude: Sequence[str]) -> None:
        self._repository, self._envelopes, self._exclude = repository, envelopes, exclude
        self._schemas: dict[tuple[tuple[str, str, str], ...], Schema] = {}

    def envelope_in(self, schema: Schema) -> str:
        """Return the full name of the envelope's message in a state, in any package; empty if the state has none."""
        last = self._envelopes[0].rpartition(".")[2]
        others = sorted(name for name in schema.messages if name.rpartition(".")[2] == last)
        return next((name for name in (*self._envelopes, *others) if name in schema.messages), "")

    def consumers(self, pins: Sequence[Pin], findings: list[Diagnostic]) -> list[tuple[Consumer, ProtoState]]:
        """Return the consumer of each pin, with the state that it uses.

        The file or repository with the pins may also pin other repositories. So an unknown commit is only reported if
        the pin comes from a list of pins, or if its address is that of this repository. A file or repository without
        any known commit is reported as well.
        """
        read: list[tuple[Consumer, ProtoState]] = []
        faults: list[Diagnostic] = []
        ours = self._repository.names() if pins else set()
        for pin in pins:
            try:
                commit = self._commit(pin)
                read.append((Consumer(pin, commit), self._state(commit)))
            except LookupError as error:
                if pin.listed or name_of_repository(pin.address) in ours:
                    message = f"the project {pin.consumer!r} is pinned to {pin.commit!r}, which {error.args[0]}"
                    faults.append(UnreadablePins.at(pin.span, message, _FETCH))
        findings += faults or _without_any(pins, {consumer.pin.source for consumer, _ in read})
        findings += _broken_states(read)
        return read

    def _commit(self, pin: Pin) -> Commit:
        try:
            return self._repository.commit(pin.commit)
        except GitError as error:
            raise LookupError("this repository does not have") from error

    def _state(self, commit: Commit) -> ProtoState:
        """Return the state at a commit.

        Raises `LookupError` if a file of the commit cannot be read, or if the commit does not declare the envelope.
        """
        entries = tuple(entry for entry in self._repository.entries(commit.id) if _counts(entry))
        if entries not in self._schemas:
            self._schemas[entries] = self._schema(commit.id)
        schema = self._schemas[entries]
        if envelope := self.envelope_in(schema):
            return ProtoState(schema, envelope)
        raise LookupError(f"has no message {self._envelopes[0]!r}")

    def _schema(self, commit: str) -> Schema:
        shown_root = self._repository.in_commit(commit[:10])
        unread: list[Diagnostic] = []
        with checked_out(self._repository, commit, commit[:10], unread) as checkout:
            folder = checkout.folder
            checkout.add_submodules("", [])
            files = [file for file in proto_files(folder, shown_root, unread) if file not in self._exclude]
            schema, _ = compile_tree(folder, files, shown_root)
            texts = {file: read_proto(folder, file, shown_root, unread) for file in schema.uncompiled}
        for finding in unread:
            why = f"has a file that cannot be read, {finding.span.file!r}: {finding.message}"
            raise LookupError(why)  # the repository's fault, not a caller's
        return with_uncompiled(schema, {file: declarations(text or "") for file, text in texts.items()}, shown_root)


def _counts(entry: tuple[str, str, str]) -> bool:
    mode, _, path = entry
    return mode == SUBMODULE or path.endswith(".proto")


def _without_any(pins: Sequence[Pin], known: Set[str]) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each source of pins (a file or repository) without any commit of this repository.

    ``known`` are the sources that have such a commit.
    """
    for source in dict.fromkeys(pin.source for pin in pins if pin.source not in known):
        others = ", ".join(f"{pin.consumer} ({pin.commit})" for pin in pins if pin.source == source)
        message = f"none of the pins here is a commit of this repository: {others}"
        yield UnreadablePins.at(Span(source), message, _FETCH)


def _broken_states(read: Sequence[tuple[Consumer, ProtoState]]) -> Iterator[Diagnostic]:
    """Yield a hint for each commit with a file in the envelope that does not compile."""
    for consumer, state in {consumer.commit: (consumer, state) for consumer, state in reversed(read)}.values():
        messages, enums = state.schema.reachable(state.envelope)
        files = {state.schema.messages[name].file for name in messages}
        files |= {state.schema.enums[name].file for name in enums}
        if broken := sorted(files.intersection(state.schema.uncompiled)):
            message = f"{broken[0]!r} does not compile at {consumer.commit}, and was read as far as possible"
            finding = LimitedHistory.at(consumer.pin.span, message, "defaults and other options in it are unknown")
            yield dataclasses.replace(finding, severity=Severity.HINT)
