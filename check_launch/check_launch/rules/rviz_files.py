"""Topics and frames of a configuration of RViz, which `rviz2 -d FILE` shows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

from check_launch.expansion.entities import UnreadableFileError, compose, place_of, text_of_file
from roverlink.generator.diagnostics import Span

_RELIABILITY = {"Reliable": "reliable", "Best Effort": "best_effort"}
_DURABILITY = {"Transient Local": "transient_local", "Volatile": "volatile", "System Default": "volatile"}


@dataclass(frozen=True, slots=True)
class RvizTopic:
    """A topic that RViz shows, or that one of its tools publishes."""

    plugin: str
    """Class of the display or tool, such as ``rviz_default_plugins/Map``."""
    topic: str
    place: Span
    reliability: str
    durability: str
    is_published: bool
    is_update: bool
    """True for the updates of a map, which have another message type than the display."""
    is_enabled: bool
    """False for a display that is switched off: it subscribes to nothing until a user switches it on."""


@dataclass(frozen=True, slots=True)
class RvizFile:
    """Contents of a configuration that depend on other nodes."""

    topics: tuple[RvizTopic, ...]
    plugins: tuple[tuple[str, Span], ...]
    """Classes of all displays and tools."""
    fixed_frame: tuple[str, Span] | None


def read_rviz_file(path: str, shown: str) -> RvizFile | None:
    """Read a configuration; None if there is none that can be read."""
    try:
        return _contents(text_of_file(Path(path), shown), shown)
    except UnreadableFileError:
        return None


@cache
def _contents(text: str, shown: str) -> RvizFile:
    root = compose(text, shown)
    manager = _entries(root).get("Visualization Manager")
    topics: list[RvizTopic] = []
    plugins: list[tuple[str, Span]] = []
    for name, is_tool in (("Displays", False), ("Tools", True)):
        for node in _with_class(_entries(manager).get(name)):
            entries = _entries(node)
            plugin = entries["Class"]
            plugins.append((str(plugin.value), place_of(plugin, shown)))
            topics += _topics(entries, str(plugin.value), is_tool, shown)
    frame = _entries(_entries(manager).get("Global Options")).get("Fixed Frame")
    fixed = (str(frame.value), place_of(frame, shown)) if isinstance(frame, yaml.ScalarNode) else None
    return RvizFile(tuple(topics), tuple(plugins), fixed)


def _entries(node: yaml.Node | None) -> dict[str, yaml.Node]:
    if not isinstance(node, yaml.MappingNode):
        return {}
    return {key.value: value for key, value in node.value if isinstance(key, yaml.ScalarNode)}


def _with_class(node: yaml.Node | None) -> Iterator[yaml.Node]:
    """Yield the displays in a list, and those in groups of displays."""
    for item in node.value if isinstance(node, yaml.SequenceNode) else ():
        entries = _entries(item)
        if isinstance(entries.get("Class"), yaml.ScalarNode):
            yield item
        yield from _with_class(entries.get("Displays"))


def _topics(entries: dict[str, yaml.Node], plugin: str, is_tool: bool, shown: str) -> Iterator[RvizTopic]:
    for name, node in entries.items():
        inner = _entries(node)
        value = inner.get("Value")
        if not name.endswith("Topic") or not isinstance(value, yaml.ScalarNode) or not value.value:
            continue
        reliability = str(getattr(inner.get("Reliability Policy"), "value", ""))
        durability = str(getattr(inner.get("Durability Policy"), "value", ""))
        yield RvizTopic(
            plugin,
            str(value.value),
            place_of(value, shown),
            _RELIABILITY.get(reliability, ""),
            _DURABILITY.get(durability, ""),
            is_tool,
            name == "Update Topic",
            str(getattr(entries.get("Enabled"), "value", "true")).lower() != "false",
        )
