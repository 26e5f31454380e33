"""Which type a topic has, and how a message is printed: shared by ``echo`` and ``pub``."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Mapping
from typing import Any

import yaml

from runtime import Registry, SetupError, standard
from runtime.messages import Message
from runtime.middleware import NodeIdentity
from runtime.values import nearest


def message_type(registry: Registry, topic: str, type_name: str | None) -> type[Message]:
    """The type of a topic: by its name, or that of its row. Raises `SetupError` where there is none."""
    if type_name is None:
        handler = next((h for h in registry.handlers if full_topic(h.route.topic) == full_topic(topic)), None)
        if handler is None:
            hint = nearest(topic.removeprefix("/"), registry.by_topic)
            raise SetupError(f"no row has the topic {topic!r} ({hint}); of any other topic, say the --type")
        found: type[Message] = handler.message_type
        return found
    wanted = standard.full_name(type_name)
    for handler in registry.handlers:
        if handler.message_type.__msgtype__ == wanted:
            own: type[Message] = handler.message_type
            return own
    return standard.message_type(wanted)


def full_topic(topic: str) -> str:
    """A topic as the graph knows it: relative names are in the root namespace."""
    return topic if topic.startswith("/") else f"/{topic}"


def identity(command: str) -> NodeIdentity:
    """A name of our own on the graph, different for every process."""
    return NodeIdentity(f"roverlink_{command}_{os.getpid()}")


def yaml_text(values: Mapping[str, Any]) -> str:
    """A message as ``ros2 topic echo`` prints it, which is as PyYAML writes it: a block, no line folded."""
    return yaml.safe_dump(dict(values), sort_keys=False, allow_unicode=True, width=sys.maxsize)


def json_text(values: Mapping[str, Any]) -> str:
    """A message as one JSON object on one line; what JSON has no number for is a string, as protobuf's JSON has it."""
    return json.dumps(_json_ready(values), allow_nan=False)


def _json_ready(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _json_ready(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_json_ready(element) for element in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")
    return value
