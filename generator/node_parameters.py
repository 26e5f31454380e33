"""The parameters of the node that runs what is generated, as `config/udp.yaml` shows them.

`runtime.parameters` reads them; generator and runtime do not import each other, so a test holds the two together.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NodeParameter:
    """A parameter that the node has whatever the table says."""

    name: str
    default: int | str
    meaning: str


_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # boards are other machines

NODE_PARAMETERS = (
    NodeParameter("listen_port", 5000, "UDP port for the datagrams of all peers; 0 takes a free one"),
    NodeParameter("listen_address", _EVERY_ADDRESS, "address of the interface to listen on"),
    NodeParameter("dst_ip", "127.0.0.1", "the host that has the peers' ports"),
    NodeParameter("forward_policy", "mapping", "mapping: as each row's forward says; all: every datagram to all peers"),
    NodeParameter("source_policy", "mapping", "mapping: who may speak as each peer's sources say; any: everybody"),
    NodeParameter("max_datagram", 1472, "longest datagram in bytes that is taken"),
    NodeParameter("receive_buffer", 4_194_304, "bytes that the kernel is asked to hold for the bridge"),
)
