"""Two peers have the same port parameter, or a peer uses a parameter of the node itself.

The parameter is a ROS 2 parameter of the bridge's node, and sets the UDP port of a peer. A shared parameter would
change both peers, or another setting of the node.

Bad::

    peers:
      hardware: {parameter: dst_port}
      basestation: {parameter: dst_port}

Good::

    peers:
      hardware: {parameter: dst_b_port}
      basestation: {parameter: dst_a_port}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.node_parameters import node_parameters
from roverlink.generator.table import PeerSettings

RULE = Rule("TAB104", "peer-parameter-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each peer whose port parameter belongs to another peer or to the node."""
    seen: dict[str, PeerSettings] = {}
    of_the_node = {"use_sim_time", *node_parameters()}
    for peer in context.table.peers:
        first = seen.setdefault(peer.parameter, peer)
        if first is not peer:
            message = (
                f"the parameter {peer.parameter!r} of the peer {peer.name!r} already belongs to the peer {first.name!r}"
            )
            yield RULE.at(peer.at("parameter"), message, "give each peer its own `parameter`")
        elif peer.parameter in of_the_node:
            message = (
                f"the parameter {peer.parameter!r} of the peer {peer.name!r} is already a parameter of the node itself"
            )
            yield RULE.at(peer.at("parameter"), message, f"write `parameter: dst_{peer.name}_port`")
