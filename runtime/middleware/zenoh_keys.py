"""Keys, liveliness tokens and attachments by which the nodes of rmw_zenoh_cpp find and understand each other.

rmw_zenoh's ``docs/design.md`` describes them:
- *Data key*: ``<domain>/<name>/<type>/<type hash>`` of a topic or a service, such as
  ``0/chatter/std_msgs::msg::dds_::String_/RIHS01_...``.
- *Token*: each node, publisher, subscription, service and client declares one. It ends when its session ends.
- *Attachment*: 33 bytes beside each message. A subscription of rmw_zenoh discards messages without it.
"""

from __future__ import annotations

import itertools
import os
import struct
import time
from dataclasses import dataclass
from typing import NamedTuple

import xxhash

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.middleware.protocol import NodeIdentity

ADMIN_SPACE = "@ros2_lv"
NODE, PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT = "NN", "MP", "MS", "SS", "SC"
"""Kinds of tokens."""
DEFAULT_QOS = Qos()
_NO_HASH = "TypeHashNotSupported"  # Humble has no type hashes, and a part of a key must not be empty
_ATTACHMENT = struct.Struct("<qqB16s")  # number, ns since the epoch, length of the GID, GID
_GID_BYTES = 16
_PARTS_OF_NODE = 9
# Values of rmw's enums that are not the defaults; a default is an empty text.
_BEST_EFFORT, _TRANSIENT_LOCAL, _KEEP_ALL = "2", "1", "2"
_DEFAULT_DEPTH = 42
_UNSET = ",:,:,,"  # deadline, lifespan, liveliness with its lease


@dataclass(frozen=True, slots=True)
class Entity:
    """Node, publisher, subscription, service or client that a token announces."""

    kind: str
    session: str
    """Zenoh id of the node's session."""
    node: NodeIdentity
    name: str = ""
    """Fully qualified name of the topic or service; empty for a node."""
    type: str = ""
    """DDS name of the type."""
    hash: str = ""
    qos: Qos = DEFAULT_QOS

    def key(self, domain: int) -> str:
        """Return the data key of the topic or the service."""
        return f"{domain}{self.name}/{self.type}/{self.hash}"

    def token(self, domain: int, number: int) -> str:
        """Return the text of the token; ``number`` differs between the entities of a session."""
        node = f"{self.session}/0/{number}/{self.kind}/%/{_mangled(self.node.namespace)}/{self.node.name}"
        topic = f"/{_mangled(self.name)}/{self.type}/{self.hash}/{_qos_text(self.qos)}" if self.name else ""
        return f"{ADMIN_SPACE}/{domain}/{node}{topic}"


def entity_of(token: str) -> Entity | None:
    """Return what a token announces; None for a token that is none of rmw_zenoh. Newer releases append parts."""
    parts = token.split("/")
    if len(parts) < _PARTS_OF_NODE:
        return None
    session, kind, namespace, name = parts[2], parts[5], parts[7], parts[8]
    node = NodeIdentity(name, namespace.replace("%", "/"))
    if kind == NODE:
        return Entity(kind, session, node)
    topic, *rest = parts[_PARTS_OF_NODE:]
    if kind not in (PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT) or len(rest) < 3:
        return None
    return Entity(kind, session, node, topic.replace("%", "/"), rest[0], rest[1], _qos_of(rest[2]))


def hash_in_key(type_hash: str) -> str:
    """Return the part of a key for a type hash, as the distribution in ``ROS_DISTRO`` writes it (default: Humble)."""
    return _NO_HASH if os.environ.get("ROS_DISTRO", "humble") == "humble" else type_hash


class Attachment(NamedTuple):
    """Facts that rmw_zenoh sends beside a message: its number, when it was sent (in ns since 1970), and the sender."""

    number: int
    sent: int
    gid: bytes

    def packed(self) -> bytes:
        """Return the bytes of the attachment."""
        return _ATTACHMENT.pack(self.number, self.sent, _GID_BYTES, self.gid)

    @classmethod
    def unpacked(cls, data: bytes) -> Attachment | None:
        """Return the facts in an attachment; None if it is none of rmw_zenoh."""
        if len(data) != _ATTACHMENT.size:
            return None
        number, sent, _, gid = _ATTACHMENT.unpack(data)
        return cls(number, sent, gid)


class Attachments:
    """Attachments of one sender, with rising numbers."""

    def __init__(self, token: str) -> None:
        """Number the messages of the entity with this token, from which rmw_zenoh computes the GID."""
        self._gid = xxhash.xxh3_128_intdigest(token.encode()).to_bytes(_GID_BYTES, "little")
        self._numbers = itertools.count(1)

    def next(self) -> bytes:
        """Return the attachment of the next message."""
        return Attachment(next(self._numbers), time.time_ns(), self._gid).packed()


def _mangled(name: str) -> str:
    return name.replace("/", "%")


def _qos_text(qos: Qos) -> str:
    reliability = _BEST_EFFORT if qos.reliability == "best_effort" else ""
    durability = _TRANSIENT_LOCAL if qos.durability == "transient_local" else ""
    kept = _KEEP_ALL if qos.history == "keep_all" else ""
    return f"{reliability}:{durability}:{kept},{'' if qos.depth == _DEFAULT_DEPTH else qos.depth}:{_UNSET}"


def _qos_of(text: str) -> Qos:
    reliability, durability, history, *_ = (*text.split(":"), "", "", "")
    kept, _, depth = history.partition(",")
    return Qos(
        "best_effort" if reliability == _BEST_EFFORT else "reliable",
        "transient_local" if durability == _TRANSIENT_LOCAL else "volatile",
        "keep_all" if kept == _KEEP_ALL else "keep_last",
        int(depth) if depth.isdecimal() else _DEFAULT_DEPTH,
    )
