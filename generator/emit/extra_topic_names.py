"""The names of extra topics in generated code."""

from __future__ import annotations

import dataclasses
import keyword
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.ir import Feed, ros_names


@dataclass(frozen=True, slots=True)
class NamedFeed:
    """An extra topic of a row, with its names."""

    route: ir.Route
    """The row, with the topic and the quality of service of the extra topic, and without the settings of its own."""
    feed: Feed
    file: str
    """The name of its module, without a suffix: ``imu_data_raw``."""
    name: str
    """The name of its class: ``ImuDataRawTopic``."""


def named_feeds(bridge: ir.Bridge) -> list[NamedFeed]:
    """Return every extra topic, named after the topic; an underscore tells apart what would have one name."""
    found: list[NamedFeed] = []
    names: set[str] = set()
    files: set[str] = set()
    for route in bridge.routes:
        for feed in route.also:
            words = feed.topic.strip("~/").split("/")
            name = "".join(map(ros_names.camel_case, words))
            while name.lower() in names:
                name += "_"
            names.add(name.lower())
            file = "_".join(words).lower()
            while file in files or keyword.iskeyword(file):
                file += "_"
            files.add(file)
            found.append(NamedFeed(_on_topic(route, feed), feed, file, f"{name}Topic"))
    return found


def _on_topic(route: ir.Route, feed: Feed) -> ir.Route:
    return dataclasses.replace(
        route, topic=feed.topic, qos=feed.qos, forward=(), deadman=None, max_rate=None, expect_rate=None
    )
