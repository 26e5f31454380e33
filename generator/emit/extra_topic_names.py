"""What generated code calls the feeds that stand beside a row's own topic."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.ir import Feed, ros_names


@dataclass(frozen=True, slots=True)
class NamedFeed:
    """A feed of a row, with its names."""

    route: ir.Route
    """The row, with the feed's topic and quality of service, and without what only the row's own topic has."""
    feed: Feed
    file: str
    """The name of its file, without what the language puts behind: ``imu_info_imu_data_raw``."""
    name: str
    """The name of its class: ``ImuInfoImuDataRawFeed``."""


def named_feeds(bridge: ir.Bridge) -> list[NamedFeed]:
    """Every feed beside the rows' own, each name given once."""
    found: list[NamedFeed] = []
    names: set[str] = set()
    files: set[str] = set()
    for route in bridge.routes:
        for feed in route.also:
            words = [route.name, *feed.topic.strip("~/").split("/")]
            name = "".join(ros_names.camel_case(word) for word in words) + "Feed"
            while name.lower() in names:
                name = f"{name.removesuffix('Feed')}_Feed"
            names.add(name.lower())
            file = "_".join(words).lower()
            while file in files:
                file += "_"
            files.add(file)
            found.append(NamedFeed(_turned(route, feed), feed, file, name))
    return found


def _turned(route: ir.Route, feed: Feed) -> ir.Route:
    return dataclasses.replace(
        route, topic=feed.topic, qos=feed.qos, forward=(), deadman=None, max_rate=None, expect_rate=None
    )
