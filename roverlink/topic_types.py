"""Topics and their messages for commands: options, types, the wait for a subscriber, and YAML or JSON text."""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import sys
import time
from collections.abc import Collection, Mapping
from typing import Any

import yaml

from roverlink import standard_types
from roverlink.completion import complete, topics_of_nodes
from roverlink.console import NoProjectError, print_note, project_folder, seconds
from roverlink.generated_code import load_project
from roverlink.nodes import FullName
from roverlink.nodes.installed import declared_topics
from roverlink.runtime import NODE, Qos, Registry, SetupError
from roverlink.runtime.core.errors import nearest
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Middleware, NodeIdentity, Publisher
from roverlink.runtime.ros_arguments.ros_args import RosArguments

FLUSH_S = 0.2
"""Time in seconds before a publisher may leave: a reliable reader may still ask for a lost sample."""
_LOOK_S = 0.02
_DISCOVERY_S = 1.5  # a publisher on another computer is found in less
# YAML 1.1 treats these characters as line breaks, and folds them when it reads the text back.
_UNICODE_BREAKS = frozenset("\x85\u2028\u2029")
_TOPIC = re.compile(r"(~?/)?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)


class UnknownTopicError(SetupError):
    """Error of a command whose topic has no known message type."""


def add_topic(parser: argparse.ArgumentParser) -> None:
    """Add the arguments ``topic`` (its name) and ``--type`` (its message type, if no row has the topic) to a parser."""
    complete(parser.add_argument("topic", help="name of the ROS 2 topic, such as imu_data"), topics_of_nodes)
    parser.add_argument(
        "--type",
        metavar="PKG/msg/NAME",
        help="type of the messages, such as std_msgs/msg/String; needed only for a topic that is neither in "
        "mapping.yaml nor declared by an installed program, and that no node has yet",
    )


def add_wait(parser: argparse.ArgumentParser, condition: str = "") -> None:
    """Add the option ``--wait`` to a parser, for `wait_for_subscriber`; ``condition`` is the beginning of its help."""
    parser.add_argument(
        "--wait",
        type=seconds,
        default=3.0,
        metavar="S",
        help=f"{condition}wait at most S seconds for a subscriber, then publish anyway (default: 3)",
    )


def wait_for_subscriber(publishers: Collection[Publisher], seconds: float, note: str) -> None:
    """Wait until one of the topics has a subscriber; after ``seconds`` seconds, print a note and return.

    Messages that are published before a subscriber is there are lost.
    """
    deadline = time.monotonic() + seconds
    while not any(publisher.has_subscribers() for publisher in publishers):
        if time.monotonic() > deadline:
            print_note(f"{note}; publishing anyway")
            return
        time.sleep(_LOOK_S)


def endpoint_of(arguments: argparse.Namespace, ros: RosArguments, middleware: Middleware) -> tuple[type[Message], Qos]:
    """Return the message type and the QoS of the topic that a command line names; see `endpoint`.

    ``arguments`` has the options of `add_topic` and `add_project`. Without a project, only standard types are known.
    If nothing else tells the type, a node that has the topic does. Raises `NoProjectError` or `SetupError` if there is
    none.
    """
    registry: Registry | None = None
    try:
        registry = load_project(project_folder(arguments.project))
        return endpoint(registry, arguments.topic, arguments.type, ros.topic)
    except NoProjectError:
        if arguments.type is not None:
            return endpoint(None, arguments.topic, arguments.type)
        if found := _discovered_type(middleware, ros.topic(arguments.topic)):
            return _named_type(None, found), Qos()
        raise
    except UnknownTopicError:
        if found := _discovered_type(middleware, ros.topic(arguments.topic)):
            return _named_type(registry, found), Qos()
        raise


def _discovered_type(middleware: Middleware, topic: str) -> str:
    """Return the type that a publisher or a subscription of a topic has; empty if none appears for a while."""
    deadline = time.monotonic() + _DISCOVERY_S
    while True:
        for endpoint in (*middleware.endpoints(topic, True), *middleware.endpoints(topic, False)):
            if endpoint.type:
                return endpoint.type
        if time.monotonic() > deadline:
            return ""
        time.sleep(_LOOK_S)


def endpoint(
    registry: Registry | None, topic: str, type_name: str | None, full_name: FullName | None = None
) -> tuple[type[Message], Qos]:
    """Return the message type and the QoS of a topic; ``registry`` is None if there is no project.

    If ``type_name`` is given, such as ``std_msgs/msg/String``, they are this type and the default QoS. Otherwise they
    are those of the row that has the topic, or the type that a node of an installed package declares for it.
    ``full_name`` makes full names of topics, if the nodes have a namespace or remap topics. Raises `SetupError` if the
    name of the topic is invalid, and `UnknownTopicError` if there is neither a type, a row nor a declaration.
    """
    if not _TOPIC.fullmatch(topic):
        raise SetupError(
            f"{topic!r} is not a topic name: use letters, digits and underscores, with slashes between the parts"
        )
    if type_name is not None:
        return _named_type(registry, type_name), Qos()
    full, known = full_name or full_topic, registry.by_topic if registry else {}
    for handler in known.values():
        if full(handler.route.topic) == full(topic):
            return handler.message_type, handler.route.qos
    for declared in declared_topics().values():
        if full(declared.name) == full(topic) and len(declared.types) == 1:
            return declared.message_type, Qos()
    hint = nearest(topic.removeprefix("/"), known)
    raise UnknownTopicError(
        f"no row of mapping.yaml has the topic {topic!r} ({hint}), and no node; for a topic without a row, give its "
        "message type with --type PKG/msg/NAME"
    )


def _named_type(registry: Registry | None, type_name: str) -> type[Message]:
    wanted = standard_types.full_name(type_name)
    for handler in registry.by_topic.values() if registry else ():
        if handler.message_type.__msgtype__ == wanted:
            own: type[Message] = handler.message_type
            return own
    return standard_types.message_type(wanted)


def full_topic(topic: str) -> str:
    """Return the fully qualified name of a topic of the table: ``imu_data`` -> ``/imu_data``.

    The name is right if the node of the bridge has its default name and namespace, and does not remap the topic.
    """
    return NodeIdentity(NODE).topic(topic)


def identity(command: str) -> NodeIdentity:
    """Return the name of the ROS 2 node that a command is, with the process id: ``roverlink_echo_4711``."""
    return NodeIdentity(f"roverlink_{command}_{os.getpid()}")


def yaml_text(values: Mapping[str, Any]) -> str:
    """Return the values of a message as YAML, in the form of ``ros2 topic echo``. Long lines are not folded."""
    # width: PyYAML folds long texts at 80 columns by default.
    return yaml.dump(dict(values), Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=sys.maxsize)


class _Dumper(yaml.SafeDumper):
    """Writer of YAML that quotes texts with Unicode line breaks.

    PyYAML's own writer does not quote them, so they change when the text is read again.
    """

    def represent_text(self, text: str) -> yaml.ScalarNode:
        style = '"' if _UNICODE_BREAKS.intersection(text) else None
        return self.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _Dumper.represent_text)


def json_text(values: Mapping[str, Any]) -> str:
    """Return the values of a message as one line of JSON. NaN and infinity become strings, as in protobuf's JSON."""
    return json.dumps(_json_ready(values), allow_nan=False)


def _json_ready(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _json_ready(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_json_ready(element) for element in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")
    return value
