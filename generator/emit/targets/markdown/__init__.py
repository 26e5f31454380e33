"""Target `markdown`: the page docs/messages.md about all messages between the peers and ROS 2.

The page shows senders and receivers, and each message with its fields, units, sizes and an example.
"""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.markdown.page import page


def emit(bridge: ir.Bridge) -> Files:
    """Yield the page docs/messages.md."""
    top = header(bridge.table, "<!--", " -->")
    yield "docs/messages.md", render("messages.md.j2", header=top, page=page(bridge))
