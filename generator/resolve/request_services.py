"""Requests: rows that another row answers, and the types of the ROS 2 services for them."""

from __future__ import annotations

import dataclasses

from roverlink.generator import ir
from roverlink.generator.resolve.messages import RosMessages
from roverlink.generator.table import Row, Table

ERROR = "error"
"""Field of a service's response that says why there is no response; empty if the request was answered."""
_ERROR = ir.RosField(ERROR, ir.RosType("string"), "Why the request has no response; empty if it was answered.")


def request(row: Row, table: Table, messages: RosMessages) -> ir.Request | None:
    """Return the request of a row; None if it is none, or if it has a mistake, which a rule of the lint reports."""
    settings = row.request
    response = next((other for other in table.rows if settings and other.name == settings.response), None)
    if settings is None or response is None or response.proto not in messages.schema.messages:
        return None
    asked, answered = messages.conversion(row), messages.conversion(response)
    if asked is None or answered is None:
        return None
    field, service = settings.field or "", None
    if type := row.service_type:
        request = _without(field, asked, messages, f"{type}_Request")
        answer = _without(field, answered, messages, f"{type}_Response")
        answer = dataclasses.replace(answer, fields=(_ERROR, *answer.fields))
        service = ir.Service(settings.service, type, request, answer)
    return ir.Request(settings.response, field, settings.timeout_ms, settings.attempts, service)


def _without(field: str, conversion: ir.Conversion, messages: RosMessages, name: str) -> ir.RosMessage:
    """Return a ROS message with another name, and without the ROS field that holds the proto field ``field``."""
    message = messages.messages[conversion.ros]
    left_out = {one.ros.name for one in conversion.fields if one.proto_path == (field,)}
    fields = tuple(one for one in message.fields if one.name not in left_out)
    return dataclasses.replace(message, name=name, fields=fields)
