"""Two peers have one port parameter, or a peer has one of the node's own.

The parameter names the UDP port of a peer; setting it would move both, or change something else of the node.

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
    """Peers whose parameter another peer has, or the node itself."""
    seen: dict[str, PeerSettings] = {}
    of_the_node = {"use_sim_time", *node_parameters()}
    for peer in context.table.peers:
        first = seen.setdefault(peer.parameter, peer)
        if first is not peer:
            message = f"the parameter {peer.parameter} of {peer.name} is already that of {first.name}"
            yield RULE.at(peer.at("parameter"), message, "give each peer a parameter of its own")
        elif peer.parameter in of_the_node:
            message = f"the parameter {peer.parameter} of {peer.name} is one of the node's own"
            yield RULE.at(peer.at("parameter"), message, f"call it dst_{peer.name}_port")
