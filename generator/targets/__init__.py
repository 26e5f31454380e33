"""The targets: functions from the IR to files, as path and text. None of them writes anything."""

from __future__ import annotations

from collections.abc import Callable

from generator import ir, ledger
from generator.targets import conversions, docs, envelope, handlers, messages, pb2, registry, ros_package, schema
from generator.targets.rendering import Files

FOLDER = "generated"
"""Where the files go, but for a few that have a place of their own."""

_TARGETS: tuple[Callable[[ir.Bridge], Files], ...] = (
    conversions.emit,
    docs.emit,
    handlers.emit,
    messages.emit,
    pb2.emit,
    registry.emit,
    ros_package.emit,
    schema.emit,
)


def emit(bridge: ir.Bridge, proto_root: str, published: ledger.Ledger) -> dict[str, str]:
    """Every file that a table compiles to: its path, relative to the table, and its text.

    ``published`` is what the ledger had before.
    """
    files = {path: text for target in _TARGETS for path, text in target(bridge)}
    files[ledger.NAME] = ledger.render(bridge, published)
    if bridge.envelope.ours:
        files[f"{proto_root}/{bridge.envelope.file}"] = envelope.text(bridge.envelope, bridge.table)
    return dict(sorted(files.items()))
