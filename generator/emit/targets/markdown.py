"""docs/messages.md: what travels, field by field."""

from __future__ import annotations

from collections.abc import Mapping

from roverlink.generator import ir
from roverlink.generator.emit import extra_topic_text
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.ir.msg_types import msg_type


def emit(bridge: ir.Bridge) -> Files:
    """The page."""
    taken = {
        conversion.ros: {field.ros.name: ".".join(field.proto_path) for field in conversion.fields}
        for conversion in bridge.conversions().values()
    }
    by_name = {message.name: message for message in bridge.messages}
    carried = [route.conversion.ros for route in bridge.routes if route.conversion]
    shown = [by_name.pop(ros) for ros in dict.fromkeys(carried)]
    yield (
        "docs/messages.md",
        render(
            "messages.md.j2",
            header=header(bridge.table, "<!--", " -->"),
            package=bridge.package,
            routes=bridge.routes,
            messages_of={route.name: _message_of(route, bridge.package) for route in bridge.routes},
            feeds=[extra_topic_text.view(route, feed) for route in bridge.routes for feed in route.feeds],
            retired=bridge.envelope.retired,
            messages=[_view(message, taken.get(message.name, {})) for message in (*shown, *by_name.values())],
        ),
    )


def _message_of(route: ir.Route, package: str) -> str:
    if route.conversion:
        return f"[`{package}/msg/{route.conversion.ros}`](#{route.conversion.ros.lower()})"
    return f"[`{route.feeds[0].message}`](#standard-messages)"


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
