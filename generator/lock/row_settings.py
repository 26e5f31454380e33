"""Settings of rows on which boards and nodes rely, as mapping.lock records them.

They are the direction, the type and QoS of each topic, the peers of `forward`, the deadman, the limits, and the
request. Each setting has a key and a text, so it is one line of the ledger::

    16 ControlMode direction: basestation_to_ros
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator.diagnostics import Span
from roverlink.generator.ir import Qos
from roverlink.generator.table import Row, StandardTopicSettings, Table

DEADMAN = ("deadman after", "deadman repeat", "deadman send")
LIMITS = ("expect_rate", "max_rate", "priority", "at_least")
AMOUNTS = (*DEADMAN[:2], *LIMITS)
"""Keys of settings that are numbers. The times have the unit ``ms``."""
REQUESTS = ("request", "request service")
"""Keys of the settings of a request: its response with the field, on which peers rely, and its service."""
FORWARD = "forward "
"""Start of the keys of a forward's limits, which are numbers, too: ``forward basestation max_rate``."""
EXTRA_TOPIC = "also "
"""Start of the keys of an extra topic: ``also imu/data`` for its type, ``also imu/data qos`` for its QoS."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Setting of a row, with its place in mapping.yaml or mapping.lock."""

    text: str
    span: Span

    @property
    def amount(self) -> int:
        """The number of a setting in `AMOUNTS`; times are in milliseconds."""
        return int(self.text.removesuffix("ms"))


RowSettings = Mapping[tuple[int, str], Mapping[str, Setting]]
"""Settings by key, of each row: a row is known by its envelope number and the full name of its message."""


def settings_of_rows(table: Table) -> RowSettings:
    """Return the settings of each row of a table."""
    return {(row.number, row.proto): settings_of_row(row, table) for row in table.rows}


def settings_of_row(row: Row, table: Table) -> dict[str, Setting]:
    """Return the settings of a row by key. A setting that the row does not have is missing."""
    return dict(_settings(row, table.ros.package))


def topics_of(row: Row) -> Iterator[tuple[StandardTopicSettings, str, str]]:
    """Yield each topic of a row, first its own, with the key of its type and the key of its QoS."""
    yield row, "ros", "qos"
    for extra in row.also:
        yield extra, f"{EXTRA_TOPIC}{extra.topic}", f"{EXTRA_TOPIC}{extra.topic} qos"


def _settings(row: Row, package: str) -> Iterator[tuple[str, Setting]]:
    yield "direction", Setting(row.direction, row.at("direction"))
    for topic, type_key, qos_key in topics_of(row):
        type = topic.ros if "/" in topic.ros else f"{package}/{topic.ros}"
        yield type_key, Setting(type, row.ros_span if topic is row else topic.at("ros"))
        yield qos_key, Setting(_qos(topic.profile), _qos_span(topic))
    if row.forward:
        yield "forward", Setting(" ".join(sorted(row.forward)), row.at("forward"))
    if deadman := row.deadman:
        yield "deadman after", Setting(f"{deadman.after_ms}ms", deadman.at("after"))
        yield "deadman repeat", Setting(f"{deadman.repeat_ms}ms", deadman.at("repeat"))
        # JSON, because a text may contain line breaks, and the setting must stay one line of the ledger.
        yield "deadman send", Setting(json.dumps(dict(deadman.send), sort_keys=True), deadman.at("send"))
    if request := row.request:
        yield REQUESTS[0], Setting(" ".join(filter(None, (request.response, request.field))), request.span)
        if type := row.service_type:
            yield REQUESTS[1], Setting(f"{request.service} {package}/{type}", request.at("service"))
    for key, limit in zip(LIMITS, (row.expect_rate, row.max_rate, row.priority)):
        if limit:
            yield key, Setting(str(limit), row.at(key))
    if row.send and row.send.at_least_ms:
        yield "at_least", Setting(f"{row.send.at_least_ms}ms", row.send.at("at_least"))
    for forward in row.forward_settings:
        if forward.max_rate:
            yield f"{FORWARD}{forward.peer} max_rate", Setting(str(forward.max_rate), forward.at("max_rate"))
        if forward.at_least_ms:
            key, text = f"{FORWARD}{forward.peer} at_least", f"{forward.at_least_ms}ms"
            yield key, Setting(text, forward.at("at_least"))


def _qos(qos: Qos) -> str:
    return f"{qos.reliability} {qos.durability} {qos.history} {qos.depth}"


def _qos_span(topic: StandardTopicSettings) -> Span:
    """Return the place of the QoS of a topic: `qos` or `queue`, otherwise the topic's name."""
    return next((topic.spans[key] for key in ("qos", "queue") if key in topic.spans), topic.at("topic"))
