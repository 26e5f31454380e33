"""docs/messages.md: what travels, field by field."""

from __future__ import annotations

from collections.abc import Mapping

from generator import ir
from generator.msg_types import msg_type
from generator.rendering import Files, header, render


def emit(bridge: ir.Bridge) -> Files:
    """The page."""
    taken = {
        conversion.ros: {field.ros.name: ".".join(field.proto_path) for field in conversion.fields}
        for conversion in bridge.conversions().values()
    }
    by_name = {message.name: message for message in bridge.messages}
    shown = [by_name.pop(route.conversion.ros) for route in bridge.routes if route.conversion.ros in by_name]
    yield (
        "docs/messages.md",
        render(
            "messages.md.j2",
            header=header(bridge.table, "<!--", " -->"),
            package=bridge.package,
            routes=bridge.routes,
            retired=bridge.envelope.retired,
            messages=[_view(message, taken.get(message.name, {})) for message in (*shown, *by_name.values())],
        ),
    )


def _view(message: ir.RosMessage, taken: Mapping[str, str]) -> dict[str, object]:
    """A message for the template; ``taken`` maps its fields to the proto fields that they are taken from."""
    fields = [
        {
            "type": msg_type(field.type),
            "name": field.name,
            "source": taken.get(field.name, message.source),
            "comment": " ".join(field.comment.split()).replace("|", "\\|"),
        }
        for field in message.fields
    ]
    return {
        "name": message.name,
        "source": message.source,
        "comment": message.comment,
        "fields": fields,
        "constants": message.constants,
    }
