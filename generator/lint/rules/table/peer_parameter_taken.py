"""Two peers have the same parameter, or a peer uses a parameter of the node itself.

The parameters are ROS 2 parameters of the bridge's node, and set the host and the UDP port of a peer or of its board. A
shared parameter would change both, or another setting of the node.

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
from roverlink.generator.table import EndSettings

RULE = Rule("TAB104", "peer-parameter-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each parameter of a peer that belongs to another peer or to the node."""
    seen: dict[str, tuple[str, EndSettings]] = {}
    of_the_node = {"use_sim_time", *node_parameters()}
    for peer in context.table.peers:
        for settings, end in peer.ends:
            owner = f"the board {end.name!r} of {peer.name!r}" if peer.boards else f"the peer {peer.name!r}"
            for parameter in filter(None, (end.host_parameter, end.parameter)):
                first, place = seen.setdefault(parameter, (owner, settings))
                if place is not settings:
                    message = f"the parameter {parameter!r} of {owner} already belongs to {first}"
                    help = "give each peer its own `parameter`"
                elif parameter in of_the_node:
                    message = f"the parameter {parameter!r} of {owner} is already a parameter of the node itself"
                    help = f"write `parameter: dst_{peer.name}_port`"
                else:
                    continue
                if peer.boards or parameter == end.host_parameter:  # the table cannot set these
                    help = "choose another name for the peer or the board"
                yield RULE.at(settings.at("parameter"), message, help)
