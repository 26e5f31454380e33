"""The first phase: mapping.yaml to a `Table`, with every mistake in the file as a finding at its place."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from string import ascii_lowercase

from generator import ir, naming
from generator.diagnostics import Diagnostic, DiagnosticsError
from generator.feed_format import FEED
from generator.read_feeds import is_standard, read_feed, read_renames
from generator.table import (
    Bound,
    DeadmanSettings,
    EnumSettings,
    EnvelopeSettings,
    Lowered,
    Outputs,
    PeerSettings,
    ProtoSettings,
    RetiredRow,
    Row,
    Table,
)
from generator.table_format import ENUM, RETIRED, ROW, TABLE
from generator.table_rules import CONFLICTING_KEYS
from generator.value_types import Object
from generator.yaml_items import read_item, read_text
from generator.yaml_scalars import Item

_USUAL_TARGETS = ("python", "ros2", "markdown")
_FIRST_PORT = 6000
_REPEAT_MS = 1000
_MAINTAINER = "unnamed <unnamed@example.com>"  # package.xml wants one; example.com receives nothing (RFC 2606)


def read(path: Path, findings: list[Diagnostic], name: str | None = None) -> Table:
    """Read a table; ``name`` is how findings call the file.

    Every mistake in the file is added to the findings. What is whole is read all the same, and `Table.whole` says
    whether that is everything. Raises `DiagnosticsError` where there is nothing to read.
    """
    file = name or str(path)
    return parse(read_text(path, file), file, findings)


def parse(text: str, file: str, findings: list[Diagnostic]) -> Table:
    """The table that a text holds; as `read`."""
    before = len(findings)
    item = read_item(text, file, TABLE, "the table", findings)
    if item is None:
        raise DiagnosticsError(findings)
    whole = len(findings) == before
    return _table(file, item, whole, findings)


def _table(file: str, item: Item, whole: bool, findings: list[Diagnostic]) -> Table:
    proto, envelope, ros = item.entry("proto"), item.entry("envelope"), item.entry("ros")
    rows, retired = item.entry("messages").items, item.entry("retired").items
    enums = item.entry("enums").entries
    return Table(
        file=file,
        whole=whole,
        numbers=frozenset(row.get("number") for row in (*rows, *retired) if row.has("number")),
        proto=ProtoSettings(proto.span, proto.spans(), proto.get("root", ""), proto.texts("exclude")),
        envelope=EnvelopeSettings(
            envelope.span,
            envelope.spans(),
            envelope.get("file", ""),
            envelope.get("message", ""),
            envelope.get("oneof", ""),
            envelope.get("owner", "mapping"),
        ),
        package=ros.get("package", ""),
        package_span=ros.entry("package").span,
        maintainer=ros.get("maintainer", _MAINTAINER),
        distro=ros.get("distro", ""),
        peers=tuple(_peers(item.entry("peers"))),
        rows=tuple(_row(row, findings) for row in rows if _is_whole(row, ROW)),
        retired=tuple(
            RetiredRow(row.span, row.spans(), row.get("number"), row.get("name"), row.get("proto"))
            for row in retired
            if _is_whole(row, RETIRED)
        ),
        enums=tuple(
            EnumSettings(enum.span, enum.spans(), name, enum.get("ros"), enum.get("field"))
            for name, enum in enums.items()
            if _is_whole(enum, ENUM)
        ),
        outputs=Outputs(item.span, item.spans(), item.texts("targets") or _USUAL_TARGETS, item.texts("templates")),
        lint=tuple(_lowered(item.entry("lint"))),
    )


def _is_whole(item: Item, type: Object) -> bool:
    """Whether everything is there that must be."""
    return item.has(*(name for name, key in type.keys.items() if key.required))


def _peers(item: Item) -> Iterator[PeerSettings]:
    for index, (name, peer) in enumerate(sorted(item.entries.items())):
        letter = ascii_lowercase[index % len(ascii_lowercase)]
        yield PeerSettings(
            peer.span,
            peer.spans(),
            name,
            peer.texts("prefixes"),
            peer.get("parameter", f"dst_{letter}_port"),
            peer.get("port", _FIRST_PORT + index),
            peer.get("strip_trailing_zeros", False),
            peer.get("max_size"),
            peer.texts("sources"),
            peer.get("source_rate"),
        )


def _row(item: Item, findings: list[Diagnostic]) -> Row:
    ros = item.get("ros", naming.camel_case(item.get("proto").rpartition(".")[2]))
    qos = _qos(item, findings)
    standard = is_standard(ros)
    return Row(
        item.span,
        item.spans(),
        number=item.get("number"),
        name=item.get("name"),
        proto=item.get("proto"),
        ros=ros,
        topic=item.get("topic"),
        direction=item.get("direction"),
        qos=qos,
        fields={} if standard else read_renames(item, findings),
        ignore=item.texts("ignore"),
        forward=item.texts("forward"),
        bounds={
            path: Bound(bound.get("length"), bound.get("count")) for path, bound in item.entry("bounds").entries.items()
        },
        lint=tuple(_lowered(item.entry("lint"))),
        presence={path: entry.value for path, entry in item.entry("presence").entries.items()},
        anys={path: tuple(type.value for type in entry.items) for path, entry in item.entry("any").entries.items()},
        recursion=item.get("recursion"),
        deadman=_deadman(item.entry("deadman")),
        max_rate=item.get("max_rate"),
        priority=item.get("priority", 0),
        expect_rate=item.get("expect_rate"),
        feed=read_feed(item, qos) if standard else None,
        also=tuple(read_feed(one, _qos(one, findings)) for one in item.entry("also").items if _is_whole(one, FEED)),
    )


def _deadman(item: Item) -> DeadmanSettings | None:
    if not item.has("after", "send"):
        return None
    send = {path: entry.value for path, entry in item.entry("send").entries.items()}
    return DeadmanSettings(item.span, item.spans(), item.get("after"), item.get("repeat", _REPEAT_MS), send)


def _lowered(item: Item) -> Iterator[Lowered]:
    for rule, entry in item.entries.items():
        if entry.has("severity", "reason"):
            yield Lowered(entry.span, entry.spans(), rule, entry.get("severity"), entry.get("reason"))


def _qos(item: Item, findings: list[Diagnostic]) -> ir.Qos:
    qos, usual = item.entry("qos"), ir.Qos()
    queue, depth = item.get("queue"), qos.get("depth")
    if queue is not None and depth is not None and queue != depth:
        message = f"queue is {queue}, but the depth of qos is {depth}"
        finding = CONFLICTING_KEYS.at(qos.entries["depth"].span, message, "they mean the same; keep one of them")
        findings.append(finding)
    return ir.Qos(
        qos.get("reliability", usual.reliability),
        qos.get("durability", usual.durability),
        qos.get("history", usual.history),
        queue or depth or usual.depth,
    )
