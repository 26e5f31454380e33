"""``roverlink echo``: print the messages of a topic, without a ROS installation."""

from __future__ import annotations

import argparse
import queue
import sys
import time
from collections.abc import Sequence

from roverlink import topic_types
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_middleware,
    add_project,
    command,
    count,
    project_folder,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import open_middleware
from roverlink.runtime.text.values import message_to_values


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "echo",
        "print the messages of a topic, as `ros2 topic echo` does, without a ROS installation",
        "roverlink echo imu_data --count 1",
    )
    add_project(parser)
    parser.add_argument("topic", help="name of the ROS 2 topic")
    parser.add_argument(
        "--type",
        metavar="PKG/msg/NAME",
        help="type of the messages, needed only for a topic that is not in mapping.yaml",
    )
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
        help="subscribe with best-effort reliability; needed if the publisher uses it, as many sensor drivers do",
    )
    add_middleware(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the messages of a topic until Ctrl-C or until ``--count`` messages have come; the exit code is then 0.

    If ``--timeout`` is over before, the exit code is 1.
    """
    registry = load_project(project_folder(arguments.project))
    message_type, published = topic_types.endpoint(registry, arguments.topic, arguments.type)
    reliability = "best_effort" if arguments.best_effort else published.reliability
    # A deep queue, because printing is slower than a burst.
    qos = Qos(reliability, published.durability, depth=1000)
    arrived: queue.Queue[bytes] = queue.Queue()
    seen = 0

    def put_all(messages: Sequence[bytes]) -> None:
        for message in messages:
            arrived.put(message)

    with open_middleware(arguments.middleware, topic_types.identity("echo")) as middleware:
        middleware.subscribe(topic_types.full_topic(arguments.topic), message_type, qos, put_all)
        deadline = None if arguments.timeout is None else time.monotonic() + arguments.timeout
        while arguments.count is None or seen < arguments.count:
            try:
                data = arrived.get(timeout=None if deadline is None else max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                print(f"stopped after {arguments.timeout} s: too few messages on {arguments.topic}", file=sys.stderr)
                return FINDINGS
            values = message_to_values(cdr.decode(message_type, data))
            print(
                topic_types.json_text(values) if arguments.json else f"{topic_types.yaml_text(values)}---", flush=True
            )
            seen += 1
    return OK
