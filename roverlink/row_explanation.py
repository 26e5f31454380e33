"""Facts about a row of mapping.yaml for ``roverlink explain``: on the wire, in ROS 2 and in the generated code."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from roverlink.generated_code import load_project
from roverlink.generator import ir
from roverlink.generator.diagnostics import shown
from roverlink.generator.emit import extra_topic_text
from roverlink.generator.emit.emitter import FOLDER, placed
from roverlink.generator.emit.extra_topic_names import named_extra_topics
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.type_hashes import type_hashes
from roverlink.generator.example_payloads import EXAMPLE_S, payload_at
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.project import Question, lint_project
from roverlink.generator.nanopb import Unbounded, envelope_size, largest_size
from roverlink.generator.node_parameters import largest_accepted
from roverlink.generator.pipeline import Compiled, compile_table
from roverlink.generator.protos.schema import ProtoField
from roverlink.generator.table import Row
from roverlink.runtime.bridge.request_rows import exchanges, in_python
from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.native.core import open_core
from roverlink.transport_addresses import largest_datagram, names_transport
from roverlink.wire_dump import wire_lines

_NUMBER = re.compile("[0-9]{1,9}")  # the largest field number, 536870911, has nine digits


class Project:
    """Table (mapping.yaml) of a project, compiled and linted, as the source of all facts about its rows.

    With ``history``, the meanings of the numbers in git's history are read, too. Raises `DiagnosticsError` if the table
    does not compile.
    """

    def __init__(self, table: Path, *, history: bool) -> None:
        self.folder = table.resolve().parent
        self.compiled: Compiled = compile_table(table)
        self.context: Context = lint_project(table, Question(history=history)).context
        self.hashes = type_hashes(self.compiled.bridge)

    def find(self, word: str) -> Row | None:
        """Return the row whose number, name, topic, proto message or ROS message is ``word``; None if there is none."""
        for row in self.context.table.rows:
            if word in (str(row.number), row.name, row.topic, row.proto, row.ros):
                return row
        return None

    def taken(self, word: str) -> str:
        """Return the reason why a new row cannot have the number ``word``, such as ``is reserved in envelope.proto``.

        Returns an empty text if the number is free, or if ``word`` is not a number.
        """
        occupied = self.context.occupied(int(word)) if _NUMBER.fullmatch(word) else iter(())
        return next((why for _, _, why in occupied), "")

    def known(self) -> list[str]:
        """Return all names, topics and messages by which `find` finds a row."""
        return [name for row in self.context.table.rows for name in (row.name, row.topic, row.proto, row.ros)]

    def explain(self, row: Row) -> dict[str, Any]:
        """Return all facts about a row as JSON values, in the order in which they are printed."""
        bridge = self.compiled.bridge
        route = next(route for route in bridge.routes if route.number == row.number)
        return {
            "number": row.number,
            "name": row.name,
            "envelope": {"message": bridge.envelope.message, "file": self._proto(bridge.envelope.file)},
            "proto": {"message": row.proto, "file": self._proto(self._member(row.number).file)},
            "ros": self._ros(route),
            "topic": row.topic,
            "direction": row.direction,
            "peer": self._peer(row.peer, self.context.table.board_of(row)),
            "forward": [{**self._peer(one.peer), "limits": _text_of(one.limits)} for one in row.forward_settings],
            "send": _text_of(row.send.limits) if row.send else None,
            "max_rate": route.max_rate,
            "expect_rate": route.expect_rate,
            "deadman": self._deadman(route.deadman),
            "priority": row.priority,
            "request": self._request(route),
            "qos": {
                "reliability": route.qos.reliability,
                "durability": route.qos.durability,
                "history": route.qos.history,
                "depth": route.qos.depth,
            },
            "size": {**self._size(row), "accepted": largest_accepted() if row.inbound else None},
            "fields": [self._field(field, row) for field in (route.conversion.fields if route.conversion else ())],
            "standard": [self._standard(standard) for standard in route.standard_topics],
            "translation": self._translation(route),
            "ignored": list(row.ignore),
            "published": self._published(row.number),
            "history": self._history(row.number),
            "files": self._files(route),
            "example": self._example(row),
        }

    @staticmethod
    def _deadman(deadman: ir.Deadman | None) -> dict[str, Any] | None:
        if deadman is None:
            return None
        send = {path: value.hex() if isinstance(value, bytes) else value for path, value in deadman.send}
        return {"after_ms": deadman.after_ms, "repeat_ms": deadman.repeat_ms, "send": send}

    def _member(self, number: int) -> ir.Member:
        return next(member for member in self.compiled.bridge.envelope.members if member.number == number)

    def _ros(self, route: ir.Route) -> dict[str, Any]:
        """Return the name and the type hash of the ROS message on the row's own topic.

        The type hash, such as ``RIHS01_4d1e...``, is computed by ROS 2's rules from the definition of the message. It
        is None for a standard message, such as ``sensor_msgs/msg/Imu``, because ROS 2 defines that message.
        """
        if route.conversion is None:
            return {"message": route.standard_topics[0].message, "type_hash": None}
        name = route.conversion.ros
        return {"message": f"{self.compiled.bridge.package}/msg/{name}", "type_hash": self.hashes[name]}

    @staticmethod
    def _standard(standard: ir.StandardTopic) -> dict[str, Any]:
        """Return the facts about an extra topic, which carries a standard message (key ``also`` of the row).

        They include the proto field from which each ROS field gets its value.
        """
        fields = [{"ros": name, "takes": taken} for name, taken in extra_topic_text.fields(standard)]
        return {
            "topic": standard.topic,
            "message": standard.message,
            "fields": fields,
            "way_back": standard.obstacle or "yes",
        }

    def _translation(self, route: ir.Route) -> list[dict[str, Any]]:
        """Return the reason why Python translates the messages of each topic of a row; None if the native core does."""
        topics = dict.fromkeys((route.topic, *(standard.topic for standard in route.standard_topics)))
        try:
            registry = load_project(self.folder)
            core, matched = open_core(registry), in_python(exchanges(registry)).get(route.name)
            return [
                {"topic": one, "in_python": core.reason(registry.by_topic[one]) or matched or None} for one in topics
            ]
        except (RoverlinkError, KeyError) as error:
            return [{"topic": topic, "in_python": str(error)} for topic in topics]

    def _proto(self, file: str) -> str:
        return shown(self.context.table.proto.root, file)

    def _peer(self, name: str, board: str = "") -> dict[str, Any]:
        """Return the facts about a peer, and about the line to it, or to a board of it, if it has one."""
        peer = self.context.table.peers_by_name()[name]
        lines = [end.host for _, end in peer.ends if end.name in (name, board) and names_transport(end.host)]
        return {
            "name": name,
            "parameter": peer.parameter,
            "port": peer.port,
            "max_size": peer.max_size,
            "budget": peer.budget,
            "line": {"host": lines[0], "largest_datagram": largest_datagram(lines[0])} if lines else None,
        }

    def _request(self, route: ir.Route) -> dict[str, Any] | None:
        """Return how a request is answered; None for other rows."""
        if (request := route.request) is None:
            return None
        service = request.service
        return {
            "response": request.response,
            "field": request.field,
            "timeout_ms": request.timeout_ms,
            "attempts": request.attempts,
            "service": service and {"name": service.name, "type": f"{self.compiled.bridge.package}/srv/{service.type}"},
        }

    def _size(self, row: Row) -> dict[str, Any]:
        """Return the largest encoded sizes of the payload and of the envelope in bytes, as nanopb computes them.

        If the size has no limit, the sizes are None, and the reason is given.
        """
        schema, bounds = self.context.schema, self.context.bounds
        if bounds is None or row.proto not in schema.messages:
            return {"payload": None, "envelope": None, "unbounded": "not known"}
        payload = largest_size(schema, bounds, row.proto)
        if isinstance(payload, Unbounded):
            return {"payload": None, "envelope": None, "unbounded": f"{payload.path}: {payload.reason}"}
        envelope = envelope_size(schema, bounds, self.context.table.envelope.message, row.number, payload)
        return {"payload": payload, "envelope": envelope, "unbounded": None}

    def _field(self, field: ir.FieldConversion, row: Row) -> dict[str, Any]:
        proto = self._proto_field(row.proto, field.proto_path)
        type = field.ros.type
        return {
            "proto": ".".join(field.proto_path),
            "number": proto.number if proto else None,
            "proto_type": " ".join(filter(None, (proto.label, proto.wire_type))) if proto else "",
            "ros": field.ros.name,
            "ros_type": f"{type.name}[]" if type.is_sequence else type.name,
            "conversion": field.kind.value,
            "comment": field.ros.comment,
        }

    def _proto_field(self, message: str, path: tuple[str, ...]) -> ProtoField | None:
        """Return the field of a proto message at a path of names, such as ``("pose", "x")``; None if there is none."""
        found: ProtoField | None = None
        for name in path:
            declared = self.context.schema.messages.get(message)
            found = next((field for field in declared.fields if field.name == name), None) if declared else None
            message = found.type_name if found else ""
        return found

    def _published(self, number: int) -> list[str]:
        """Return the entries of mapping.lock for a number, as texts such as ``imu_info (SensorBoardIMUInfo)``."""
        entries = [entry for entry in self.context.ledger.entries if entry.number == number]
        return [f"{entry.name} ({entry.proto}){', retired' if entry.retired else ''}" for entry in entries]

    def _history(self, number: int) -> list[str] | None:
        """Return the payloads that have had a number in git's history, as texts with the first and the last commit.

        Returns None if the history was not requested.
        """
        if self.context.past is None:
            return None
        usages = self.context.past.history.numbers(self.context.table.envelope.message).get(number, ())
        return [
            f"{usage.type} {usage.name}, since {usage.came}" + (f", until {usage.went}" if usage.went else "")
            for usage in usages
        ]

    def _files(self, route: ir.Route) -> list[str]:
        """Return the paths of the generated files that belong only to this row and its message."""
        bridge = self.compiled.bridge
        file = self._member(route.number).file
        row = spelling.module(route.name)
        wanted = [f"generated/handlers/{row}.py"]
        for extra in named_extra_topics(bridge):
            if extra.route.number == route.number:
                wanted.append(f"generated/extra_topics/{extra.file}.py")
        if route.conversion:
            wanted.append(f"generated/messages/{spelling.message_module(route.conversion.ros)}.py")
            wanted.append(f"generated/ros/{bridge.package}/msg/{route.conversion.ros}.msg")
        if route.request and (service := route.request.service):
            parts = (service.request, service.response)
            wanted += [f"generated/services/{spelling.service_module(part)}.py" for part in parts]
            wanted.append(f"generated/ros/{bridge.package}/srv/{service.type}.srv")
        folder = spelling.proto_package(FOLDER, file).replace(".", "/")
        wanted.append(f"{folder}/{spelling.proto_module(file)}.py")
        return [path for path in (placed(path, bridge) for path in wanted) if path in self.compiled.files]

    def _example(self, row: Row) -> dict[str, Any]:
        """Return an example envelope with its bytes explained, or the reason why there is none.

        The values are those of a simulated board.
        """
        try:
            registry = load_project(self.folder)
            handler = registry.by_name[row.name]
            envelope = registry.envelope(**{row.name: payload_at(handler.payload_type, EXAMPLE_S)})
        except (RoverlinkError, KeyError, RecursionError) as error:
            return {"bytes": None, "lines": [], "missing": f"{error}; run `roverlink generate`"}
        data = envelope.SerializeToString(deterministic=True)
        lines = [line._asdict() for line in wire_lines(data, envelope.DESCRIPTOR)]
        return {"bytes": data.hex(), "lines": lines, "missing": None}


def _text_of(limits: ir.SendLimits) -> str | None:
    return limits.text if limits != ir.SendLimits() else None
