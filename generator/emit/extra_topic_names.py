"""The names of extra topics in generated code."""

from __future__ import annotations

import dataclasses
import keyword
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.ir import StandardTopic, ros_names


@dataclass(frozen=True, slots=True)
class NamedExtraTopic:
    """An extra topic of a row, with its names."""

    route: ir.Route
    """The row, with the topic and the quality of service of the extra topic, and without the settings of its own."""
    standard: StandardTopic
    file: str
    """The name of its module, without a suffix: ``imu_data_raw``."""
    name: str
    """The name of its class: ``ImuDataRawTopic``."""


def named_extra_topics(bridge: ir.Bridge) -> list[NamedExtraTopic]:
    """Return every extra topic, named after the topic; an underscore tells apart what would have one name."""
    found: list[NamedExtraTopic] = []
    names: set[str] = set()
    files: set[str] = set()
    for route in bridge.routes:
        for standard in route.extra_topics:
            words = standard.topic.strip("~/").split("/")
            name = "".join(map(ros_names.camel_case, words))
            while name.lower() in names:
                name += "_"
            names.add(name.lower())
            file = "_".join(words).lower()
            while file in files or keyword.iskeyword(file):
                file += "_"
            files.add(file)
            found.append(NamedExtraTopic(_on_topic(route, standard), standard, file, f"{name}Topic"))
    return found


def _on_topic(route: ir.Route, standard: StandardTopic) -> ir.Route:
    return dataclasses.replace(
        route, topic=standard.topic, qos=standard.qos, forward=(), deadman=None, max_rate=None, expect_rate=None
    )
