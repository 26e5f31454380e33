"""Print the messages of a topic, as `ros2 topic echo` does, without a ROS installation.

Print the messages of a topic until Ctrl-C, as `ros2 topic echo` does, without a ROS installation. Each
message is printed as YAML, followed by a line `---`. The command waits for a publisher, and subscribes with
a QoS that matches all publishers. The message type comes from mapping.yaml, from the installed programs, or
from a node that has the topic; before there is such a node, give --type. For a bridge in a namespace, give
the bridge's arguments after --ros-args: `roverlink echo imu_data --ros-args -r __ns:=/rover1`.

Example: roverlink echo imu_data --count 1
"""

from __future__ import annotations

import argparse
import math
import queue
import time
from collections.abc import Sequence

from roverlink import topic_types
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_middleware,
    add_project,
    count,
    documented_command,
    print_note,
    seconds,
)
from roverlink.numerals import counted
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import Endpoint, Middleware, open_middleware
from roverlink.runtime.middleware.following import matching_qos
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.text.values import message_to_values

_LOOK_S = 0.02
_NOTE_S = 2.0
_SETTLE_S = 0.1  # publishers that exist when the command starts become known one after the other
_QUEUE = 1000  # messages; printing is slower than a burst


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    topic_types.add_topic(parser)
    parser.add_argument(
        "--json",
        action="store_true",
        help="print each message as a JSON object on one line; its keys are the names of the ROS fields",
    )
    parser.add_argument("--count", type=count, metavar="N", help="stop after N messages")
    parser.add_argument("--timeout", type=seconds, metavar="S", help="stop after S seconds, with exit code 1")
    parser.add_argument(
        "--best-effort",
        action="store_true",
        help="subscribe with best-effort reliability, even if all publishers are reliable",
    )
    add_middleware(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Print the messages of a topic until Ctrl-C, or until ``--count`` messages have come; the exit code is then 0.

    If the time ``--timeout`` ends before, the exit code is 1.
    """
    ros = ros_args.parse(arguments.ros_args, topic_types.identity("echo").name)
    topic = ros.topic(arguments.topic)
    arrived: queue.Queue[bytes] = queue.Queue()
    seen = 0

    def put_all(messages: Sequence[bytes]) -> None:
        for message in messages:
            arrived.put(message)

    with open_middleware(arguments.middleware, ros.node) as middleware:
        message_type, _ = topic_types.endpoint_of(arguments, ros, middleware)
        middleware.check_types([message_type])
        deadline = None if arguments.timeout is None else time.monotonic() + arguments.timeout
        if publishers := _publishers(middleware, topic, deadline):
            middleware.subscribe(topic, message_type, matching_qos(publishers, _QUEUE, arguments.best_effort), put_all)
        while arguments.count is None or seen < arguments.count:
            try:
                data = arrived.get(timeout=None if deadline is None else max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                print_note(
                    f"stopped after {arguments.timeout} s: only {counted(seen, 'message')} came on {arguments.topic}",
                )
                return FINDINGS
            values = message_to_values(cdr.decode(message_type, data))
            print(
                topic_types.json_text(values) if arguments.json else f"{topic_types.yaml_text(values)}---", flush=True
            )
            seen += 1
    return OK


def _publishers(middleware: Middleware, topic: str, deadline: float | None) -> Sequence[Endpoint]:
    """Wait for the first publisher of a topic, and return all publishers of the topic.

    ``deadline`` is a time of `time.monotonic`, or None to wait without limit. If no publisher appears before the
    deadline, return an empty sequence.
    """
    note_at = time.monotonic() + _NOTE_S
    while not middleware.endpoints(topic, True):
        if deadline is not None and time.monotonic() > deadline:
            return ()
        if time.monotonic() > note_at:
            print_note(f"waiting: nothing publishes on {topic} yet")
            note_at = math.inf
        time.sleep(_LOOK_S)
    time.sleep(_SETTLE_S)
    return middleware.endpoints(topic, True)
