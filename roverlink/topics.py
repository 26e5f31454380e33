"""Which type a topic has, and how a message is printed: shared by ``echo`` and ``pub``."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from typing import Any

from runtime import Registry, SetupError, standard
from runtime.messages import Message
from runtime.middleware import NodeIdentity
from runtime.values import nearest


def message_type(registry: Registry, topic: str, type_name: str | None) -> type[Message]:
    """The type of a topic: by its name, or that of its row. Raises `SetupError` where there is none."""
    if type_name is None:
        handler = registry.by_topic.get(topic) or registry.by_topic.get(topic.removeprefix("/"))
        if handler is None:
            hint = nearest(topic.removeprefix("/"), registry.by_topic)
            raise SetupError(f"no row has the topic {topic!r}; {hint} For any other topic, say its --type")
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


def yaml_lines(values: Mapping[str, Any], indent: str = "") -> Iterator[str]:
    """A message as ``ros2 topic echo`` prints it."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield f"{indent}{name}:" if value else f"{indent}{name}: {{}}"
            yield from yaml_lines(value, f"{indent}  ")
        elif isinstance(value, list) and value:
            yield f"{indent}{name}:"
            yield from _items(value, indent)
        else:
            yield f"{indent}{name}: {_scalar(value)}"


def _items(values: list[Any], indent: str) -> Iterator[str]:
    for value in values:
        if isinstance(value, Mapping):
            first, *rest = yaml_lines(value, "  ") if value else ["  {}"]
            yield f"{indent}- {first[2:]}"
            yield from (f"{indent}{line}" for line in rest)
        else:
            yield f"{indent}- {_scalar(value)}"


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else (".inf" if value > 0 else "-.inf")
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'" if _needs_quotes(value) else value
    return "[]" if value == [] else str(value)


def _needs_quotes(text: str) -> bool:
    """Whether YAML would read a plain scalar as something else than this string."""
    return (
        not text or text != text.strip() or not text.replace("_", "a").replace("-", "a").isalnum() or text[0].isdigit()
    )
