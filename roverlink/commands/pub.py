"""Publish messages on a topic, as `ros2 topic pub` does, without a ROS installation.

Publish a message on a topic once a second until Ctrl-C (see --count and --rate), as `ros2 topic pub` does,
without a ROS installation. Use it to command a board through a running bridge. Careful: the rover may
move! Each published message gives a line such as `published 1 on drive_motor`. For a bridge in a namespace,
give the bridge's arguments after --ros-args: `--ros-args -r __ns:=/rover1`.

Example: roverlink pub drive_motor '{distance_to_go: 1.5}' --count 1
"""

from __future__ import annotations

import argparse
import time

from roverlink import topic_types
from roverlink.console import (
    OK,
    Subparsers,
    add_middleware,
    add_project,
    count,
    documented_command,
    rate,
)
from roverlink.runtime import SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NOT_ACCEPTED, open_middleware
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.text import strict_yaml
from roverlink.runtime.text.values import message_from_values


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    topic_types.add_topic(parser)
    parser.add_argument(
        "values",
        nargs="?",
        default="{}",
        help="the message's fields in YAML, such as '{speed: 1.5}'; all other fields are zero (default: {})",
    )
    parser.add_argument("--count", type=count, metavar="N", help="number of messages (default: publish until Ctrl-C)")
    parser.add_argument("-1", "--once", action="store_const", const=1, dest="count", help="the same as --count 1")
    parser.add_argument(
        "-r", "--rate", type=rate, default=1.0, metavar="HZ", help="number of messages a second (default: 1)"
    )
    topic_types.add_wait(parser)
    add_middleware(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Wait for a subscriber of the topic, and publish the message ``--count`` times, or until Ctrl-C."""
    ros, values = ros_args.parse(arguments.ros_args, topic_types.identity("pub").name), _values(arguments.values)
    with open_middleware(arguments.middleware, ros.node) as middleware:
        message_type, qos = topic_types.endpoint_of(arguments, ros, middleware)
        data = cdr.encode(message_from_values(message_type, values))
        publisher = middleware.publisher(ros.topic(arguments.topic), message_type, qos)
        topic_types.wait_for_subscriber([publisher], arguments.wait, f"no subscriber on {arguments.topic} yet")
        start, sent = time.monotonic(), 0
        while arguments.count is None or sent < arguments.count:
            time.sleep(max(0.0, start + sent / arguments.rate - time.monotonic()))
            accepted = publisher.publish([data])
            sent += 1
            print(
                f"published {sent} on {arguments.topic}" if accepted else f"not published: {NOT_ACCEPTED}",
                flush=True,
            )
        time.sleep(topic_types.FLUSH_S)
    return OK


def _values(text: str) -> object:
    try:
        return strict_yaml.load(text)
    except strict_yaml.YamlTextError as error:
        raise SetupError(f"cannot read the message: {error}") from error
