"""``roverlink replay``: send a recording to a bridge, or publish it for ROS 2 nodes."""

from __future__ import annotations

import argparse
import socket
import sys
import time
from collections.abc import Callable, Collection
from contextlib import ExitStack
from typing import TYPE_CHECKING

from roverlink import topic_types
from roverlink.commands.send import destination_of
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_middleware,
    add_project,
    add_recording,
    command,
    counted,
    project_folder,
    rate,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.runtime import SetupError
from roverlink.runtime.middleware import Publisher, open_middleware
from roverlink.runtime.ros_arguments import parameters

if TYPE_CHECKING:
    from roverlink.runtime.recording.replaying import BoardReplay, RosReplay, Timed

_FLUSH_S = 0.2  # a reliable reader may still ask for a lost sample

Send = Callable[["Timed"], None]


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "replay",
        "replay the datagrams of a recording to a bridge, or its topics to ROS 2",
        "roverlink replay run.mcap --speed 2 --as board --to 127.0.0.1:5000",
        "Replay a recording with the original time between its messages. If the table (mapping.yaml) has changed\n"
        "since the recording, each message is converted to the message types of the present table. Messages that\n"
        "have another meaning in the present table are reported and skipped (exit code 1).",
    )
    add_project(parser)
    add_recording(parser)
    parser.add_argument(
        "--as",
        dest="role",
        choices=("board", "ros"),
        default="board",
        help="board: send the recorded datagrams to a bridge, as the boards did; ros: publish the recorded topics "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--to",
        default=f"127.0.0.1:{parameters.LISTEN_PORT}",
        metavar="HOST:PORT",
        help="with --as board: address of the bridge (default: %(default)s)",
    )
    parser.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="TOPIC",
        help="with --as ros: publish only this topic; may be repeated",
    )
    parser.add_argument(
        "--commands",
        action="store_true",
        help="with --as ros: also publish the topics that command boards. This moves the rover!",
    )
    parser.add_argument(
        "--speed", type=rate, default=1.0, metavar="X", help="replay X times as fast as recorded (default: 1)"
    )
    parser.add_argument("--loop", action="store_true", help="replay again and again, until Ctrl-C")
    parser.add_argument(
        "--wait",
        type=seconds,
        default=3.0,
        metavar="S",
        help="with --as ros: wait at most S seconds for a subscriber, then publish anyway (default: 3)",
    )
    add_middleware(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Replay a recording. The exit code is 1 if a message could not be replayed."""
    from roverlink.runtime.recording.reader import Recording
    from roverlink.runtime.recording.replaying import BoardReplay, RosReplay

    registry = load_project(project_folder(arguments.project))
    recording = Recording(arguments.recording)
    with ExitStack() as stack:
        if arguments.role == "board":
            replay: BoardReplay | RosReplay = BoardReplay(recording, registry)
            send = _to_bridge(destination_of(arguments.to), stack)
        else:
            wanted = {topic if topic.startswith("/") else f"/{topic}" for topic in arguments.topic}
            replay = ros = RosReplay(recording, registry, wanted, arguments.commands)
            send = _to_topics(ros, arguments, stack)
        for note in replay.notes:
            print(note, file=sys.stderr)
        sent, took = _play(replay, send, arguments.speed, arguments.loop)
    what = "datagrams" if arguments.role == "board" else "messages"
    print(f"replayed {sent} {what} in {took:.1f} s")
    for reason, count in replay.refused.items():
        print(f"skipped {counted(count, 'message')}: {reason}", file=sys.stderr)
    return FINDINGS if replay.refused else OK


def _play(replay: BoardReplay | RosReplay, send: Send, speed: float, loop: bool) -> tuple[int, float]:
    """Send all messages at their times; return how many were sent, and how long it took in seconds."""
    from roverlink.runtime.recording.replaying import paced

    start, sent = time.monotonic(), 0
    while True:
        before = sent
        for message in paced(replay.messages(), speed):
            send(message)
            sent += 1
        if not loop or sent == before:
            return sent, time.monotonic() - start


def _to_bridge(destination: tuple[str, int], stack: ExitStack) -> Send:
    sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))

    def send(message: Timed) -> None:
        try:
            sock.sendto(message.data, destination)
        except OSError as error:
            raise SetupError(f"cannot send to {destination[0]}:{destination[1]}: {error.strerror}") from error

    return send


def _to_topics(replay: RosReplay, arguments: argparse.Namespace, stack: ExitStack) -> Send:
    if replay.left_out:
        print(f"skipped because they command the rover (see --commands): {', '.join(replay.left_out)}", file=sys.stderr)
    middleware = stack.enter_context(open_middleware(arguments.middleware, topic_types.identity("replay")))
    publishers = {
        topic: middleware.publisher(topic, endpoint.message_type, endpoint.qos)
        for topic, endpoint in replay.endpoints.items()
    }
    _wait_for_subscriber(publishers.values(), arguments.wait)
    # Registered after the middleware, so it runs before the middleware closes.
    stack.callback(time.sleep, _FLUSH_S)

    def send(message: Timed) -> None:
        publishers[message.topic].publish([message.data])

    return send


def _wait_for_subscriber(publishers: Collection[Publisher], seconds: float) -> None:
    """Wait until one of the topics has a subscriber, but at most ``seconds``.

    Messages published before that would be lost.
    """
    deadline = time.monotonic() + seconds
    while not any(publisher.has_subscribers() for publisher in publishers):
        if time.monotonic() > deadline:
            print("none of the topics has a subscriber yet; publishing anyway", file=sys.stderr)
            return
        time.sleep(0.02)
