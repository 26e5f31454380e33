"""Names of the modules and classes that are generated for extra topics: those that rows list under ``also``."""

from __future__ import annotations

import dataclasses
import keyword
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.ir import StandardTopic, ros_names


@dataclass(frozen=True, slots=True)
class NamedExtraTopic:
    """Extra topic of a row, with the names of its generated module and class."""

    route: ir.Route
    """Copy of the row's route, with the name and the QoS of the extra topic.

    It has no settings that concern only the row's own topic, such as ``deadman``.
    """
    standard: StandardTopic
    file: str
    """Name of the generated module, without a suffix: ``imu_data_raw``."""
    name: str
    """Name of the generated class: ``ImuDataRawTopic``."""


def named_extra_topics(bridge: ir.Bridge) -> list[NamedExtraTopic]:
    """Return every extra topic of the bridge, with the names of its generated code.

    The names come from the topic's name. If a name is taken, an underscore is added to it.
    """
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
    own = dataclasses.replace(route, topic=standard.topic, qos=standard.qos)
    return dataclasses.replace(own, forward=(), forward_limits=(), deadman=None, max_rate=None, expect_rate=None)
