"""Client: the other end of the link in Python, for basestations, tools and tests. It needs no ROS 2.

`Peer` is for asyncio, `BlockingPeer` for programs without it. Both send and receive payloads: the protobuf messages of
the rows. `Reassembler` puts frames together that a sender has divided into several payloads.
"""

from roverlink.runtime.client.asyncio_peer import Peer
from roverlink.runtime.client.blocking_peer import BlockingPeer
from roverlink.runtime.client.link_end import LinkEnd
from roverlink.runtime.client.pending_requests import UnansweredError
from roverlink.runtime.client.reassembly import Frame, Reassembler
from roverlink.runtime.client.repeating import Repetition
from roverlink.runtime.client.session import ClosedError, Hook, Received, Traffic

__all__ = [
    "BlockingPeer",
    "ClosedError",
    "Frame",
    "Hook",
    "LinkEnd",
    "Peer",
    "Reassembler",
    "Received",
    "Repetition",
    "Traffic",
    "UnansweredError",
]
