"""Guesses of the sender and the receiver of each payload, from names, folders and comments.

The drafted mapping.yaml marks each uncertain guess with a comment.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from roverlink.generator.adopt.draft import DraftPeer, DraftRow
from roverlink.generator.adopt.proto_tree import Tree
from roverlink.generator.adopt.role_words import (
    COMMANDS,
    GENERIC_FOLDERS,
    OPERATORS,
    REPORTS,
    ROLES,
    ROS_MACHINES,
    camel_prefix,
    words,
)
from roverlink.generator.protos.schema import ProtoField

_HARDWARE = "hardware"
_OURS = "ros"
_NO_MACHINE = "neither the name nor the folder tells which machine it belongs to"
_FROM = re.compile(r"\b(?:from|sent by|published by|measured by|reported by|comes from)\s+(?:the\s+|a\s+|all\s+)?")
_TO = re.compile(r"\b(?:to|for|received by|read by)\s+(?:the\s+|a\s+|all\s+)?")
_MACHINES = {
    "base station": "basestation",
    "basestation": "basestation",
    "ground station": "ground_station",
    "microcontroller": _HARDWARE,
    "firmware": _HARDWARE,
    "hardware": _HARDWARE,
    "boards": _HARDWARE,
    "board": _HARDWARE,
    **dict.fromkeys(sorted(ROS_MACHINES), _OURS),
}


@dataclass(frozen=True, slots=True)
class _Component:
    """Machine, such as a board, that sends or receives some of the messages."""

    prefix: str
    """First words of the names of this machine's messages; empty if only the folder names the machine."""
    peer: str


def guess_rows(tree: Tree) -> tuple[list[DraftPeer], list[DraftRow]]:
    """Return the guessed peers, and a draft of a row for each message in the envelope's oneof."""
    members = tree.members
    components = _components(tree, members)
    machines = dict(_MACHINES)
    for component in components.values():
        if component.prefix:
            machines[" ".join(words(component.prefix))] = component.peer
    rows = [_row(member, tree, components.get(member.type_name), machines) for member in members]
    names = sorted({row.peer for row in rows})
    if len(names) == 1:  # with a single peer there is no doubt about the machine
        for row in rows:
            row.doubt = row.doubt.removeprefix(_NO_MACHINE).removeprefix(" and ")
    prefixes: dict[str, set[str]] = {name: set() for name in names}
    for component in components.values():
        if component.prefix and component.peer in prefixes:
            prefixes[component.peer].add(component.prefix)
    return [DraftPeer(name, tuple(sorted(prefixes[name]))) for name in names], rows


# --- components -------------------------------------------------------------------------------------------------


def _components(tree: Tree, members: Iterable[ProtoField]) -> dict[str, _Component]:
    """Return the machine that sends or receives each payload, by the full name of the payload's message.

    A payload is left out if neither its name nor its folder shows a machine.
    """
    types = sorted({member.type_name for member in members})
    folders = {proto: PurePosixPath(tree.schema.messages[proto].file).parent.name for proto in types}
    several = len({folder for folder in folders.values() if _is_machine(folder)}) > 1
    found = {}
    for proto in types:
        name, folder = proto.rpartition(".")[2], folders[proto]
        prefix = _prefix(name, folder)
        if prefix:
            found[proto] = _Component(prefix, _peer(words(prefix)))
        elif several and _is_machine(folder):
            found[proto] = _Component("", _peer(words(folder)))
    return found


def _is_machine(folder: str) -> bool:
    return bool(folder) and folder.lower() not in GENERIC_FOLDERS


def _prefix(name: str, folder: str) -> str:
    """Return the first words of a message's name if they name a machine; empty otherwise.

    The message ``SensorBoardIMUInfo`` gives ``SensorBoard``. ``folder`` is the name of the folder with its .proto file.
    """
    own, of_folder = words(name), words(folder)
    if of_folder and _is_machine(folder) and own[: len(of_folder)] == of_folder and len(own) > len(of_folder):
        return camel_prefix(name, len(of_folder))
    # `SensorBoardIMUInfo` belongs to the "sensor board": up to three words, the last of which is the role of a machine.
    # If the next word is a role as well (`BaseStation`), the name goes on.
    for count in (1, 2, 3):
        if len(own) > count and own[count - 1] in ROLES and not (count < len(own) and own[count] in ROLES):
            return camel_prefix(name, count)
    return ""


def _peer(of_component: list[str]) -> str:
    """Return the name of the peer for a machine, given the words of the machine's name.

    All boards become the peer ``hardware``, because they usually share a port. Each machine that a person operates,
    such as a base station, becomes a peer of its own.
    """
    return "_".join(of_component) if set(of_component) & OPERATORS else _HARDWARE


# --- directions -------------------------------------------------------------------------------------------------


def _row(member: ProtoField, tree: Tree, component: _Component | None, machines: Mapping[str, str]) -> DraftRow:
    proto = tree.schema.messages[member.type_name]
    comments = f"{member.comment}\n{proto.comment}"
    sender, receiver = _named(_FROM, comments, machines), _named(_TO, comments, machines)
    peer = next((peer_name for peer_name in (sender, receiver) if peer_name not in ("", _OURS)), "")
    inbound = _inbound_by_comment(sender, receiver)
    doubts = [] if peer or component else [_NO_MACHINE]
    peer = peer or (component.peer if component else _HARDWARE)
    if inbound is None:
        inbound = _inbound_by_name(member, peer)
    if inbound is None:
        doubts.append("neither name nor comment tells who sends it")
        inbound = True
    return DraftRow(
        number=member.number,
        name=member.name,
        proto=member.type_name,
        comment=member.comment,
        peer=peer,
        inbound=inbound,
        doubt=" and ".join(doubts),
    )


def _named(introduction: re.Pattern[str], text: str, machines: Mapping[str, str]) -> str:
    """Return the peer whose machine the comment ``text`` names after words such as "sent by"; empty if it names none.

    ``introduction`` matches words such as "sent by", and ``machines`` has the peer for each machine's name.
    """
    text = " ".join(text.lower().split())
    for match in introduction.finditer(text):
        rest = text[match.end() :]
        # The longest phrase first: "base station" is not a "station". One adjective may stand before it: "the left
        # board".
        for phrase in sorted(machines, key=len, reverse=True):
            if re.match(rf"(?:\w+ )?{re.escape(phrase)}\b", rest):
                return machines[phrase]
    return ""


def _inbound_by_comment(sender: str, receiver: str) -> bool | None:
    """Return True for a message to ROS 2, False for a message to a peer, None if the comment does not tell.

    ``sender`` and ``receiver`` are the peers that the comment names, ``ros`` for ROS 2, or empty.
    """
    if sender and sender != _OURS:
        return True
    if sender == _OURS or (receiver and receiver != _OURS):
        return False
    return True if receiver == _OURS else None


def _inbound_by_name(member: ProtoField, peer: str) -> bool | None:
    """Return True if the message's name suggests that it goes to ROS 2, False if to the peer; None without a hint.

    Boards send reports and receive commands. Operators send commands and receive reports.
    """
    for name in (member.type_name.rpartition(".")[2], member.name):
        # In English the last noun tells what a thing is: a "motor command status" is a status.
        for word in reversed(words(name)):
            if word in COMMANDS or word in REPORTS:
                return (word in REPORTS) is (peer == _HARDWARE)
    return None
