"""Facts about this project's own programs for the check of launch files.

The programs are those that installed packages declare (entry points of the group ``roverlink.nodes``), which
the package rtt_slam installs for launch files, and the bridge of the generated interface package.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from check_launch.catalogue.facts import (
    OWN_SOURCE,
    Catalogue,
    Endpoint,
    NodeClass,
    Package,
    Parameter,
    Source,
    Transform,
)
from roverlink import nodes
from roverlink.nodes.bridge_node import read_table_nodes
from roverlink.nodes.installed import declared_nodes
from roverlink.runtime import NODE

PACKAGE = "rtt_slam"
"""ROS 2 package that installs commands of roverlink as programs: ``aruco_track`` is ``roverlink aruco track``."""
_TYPES: Mapping[nodes.ParameterType, str] = {str: "string", float: "double", int: "integer", bool: "bool"}
_OTHER_END = "--as"
"""Option of the bridge that makes it the bridge of another end, with other topics and parameters."""
_IMAGES = "images of the source"
"""Stands for the topic in the argument ``topic:NAME``. No parameter can have this name."""


def with_own_programs(catalogue: Catalogue, table_file: Path | None) -> Catalogue:
    """Return a catalogue that has also the programs of this project.

    ``table_file`` is the project's mapping.yaml; without it, there is no bridge.
    """
    table = read_table_nodes(table_file) if table_file else None
    declared = declared_nodes()
    packages = {PACKAGE: declared} if declared else {}
    if table:
        packages[table.package] = {f"{table.package}_node": table.bridge}
    rows = table.rows if table else {}
    own = {
        package: Package(package, "", OWN_SOURCE, {name: f"{package}::{name}" for name in programs}, {}, {})
        for package, programs in packages.items()
    }
    classes = {
        f"{package}::{name}": _class(f"{package}::{name}", node, rows)
        for package, programs in packages.items()
        for name, node in programs.items()
    }
    return replace(
        catalogue,
        sources={**catalogue.sources, OWN_SOURCE: Source("roverlink", "", "")},
        packages={**catalogue.packages, **own},
        classes={**catalogue.classes, **classes},
    )


def _class(name: str, node: nodes.NodeDeclaration, rows: Mapping[str, Sequence[nodes.Topic]]) -> NodeClass:
    parameters = {
        _pattern(parameter.name): Parameter(
            _TYPES[parameter.type], parameter.default, parameter.minimum, parameter.maximum, parameter.choices
        )
        for parameter in (nodes.USE_SIM_TIME, *node.parameters)
    }
    topics = list(node.topics_with(rows))
    endpoints = [*_endpoints(topics), *(Endpoint("action_client", action.name, action.type) for action in node.actions)]
    if node.takes_images:
        endpoints.append(Endpoint("subscription", f"$({_IMAGES})", "sensor_msgs/msg/Image", needed="true"))
        parameters[_IMAGES] = Parameter("string", "")
    transforms = (
        Transform(_value(transform.parent), _value(transform.child), _value(transform.when) if transform.when else "")
        for transform in node.transforms
    )
    arguments = {"topic:": _IMAGES} if node.takes_images else {}
    arguments |= {_OTHER_END: ""} if node.name == NODE else {}
    return NodeClass(
        name,
        default_name=node.name,
        parameters=parameters,
        endpoints=tuple(endpoints),
        transforms=tuple(transforms),
        arguments=arguments,
        topic_patterns=tuple(
            map(_pattern, (*node.other_topics, *(topic.name for topic in topics if "<" in topic.name)))
        ),
    )


def _endpoints(topics: Iterable[nodes.Topic]) -> Iterator[Endpoint]:
    """Yield the topics of a node, without those whose names are decided when it runs."""
    for topic in topics:
        if "<" in topic.name or topic.name.startswith("/tf"):  # the graph of frames shows transforms
            continue
        kind = "publisher" if topic.direction is nodes.Direction.PUBLISHED else "subscription"
        for name in topic.type_names:
            if topic.qos:
                yield Endpoint(kind, topic.name, name, topic.qos.reliability, topic.qos.durability)
            else:
                yield Endpoint(kind, topic.name, name)


def _pattern(name: str) -> str:
    """Return a name as a pattern of the catalogue: ``<stream>.rate`` is ``{*}.rate``."""
    return re.sub("<.*?>", "{*}", name)


def _value(frame: str | nodes.Parameter) -> str:
    """Return a frame, or a reference to the parameter that has it."""
    return frame if isinstance(frame, str) else f"$({frame.name})"
