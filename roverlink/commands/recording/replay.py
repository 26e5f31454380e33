"""Replay the datagrams of a recording to a bridge, or its topics to ROS 2.

Replay a recording of `roverlink record`, with the original time between its messages. With --as board, the
recorded datagrams of the peers go to a bridge again, so a bridge can be tested without boards. With
--as ros, the recorded topics are published again, so ROS 2 nodes can be tested without a bridge. Order and
pace are right even if the clock of the computer was set during the recording.

On a terminal, a line shows the progress. Keys: space pauses and continues; the left and right arrows go
10 s of the recording back and forward, the down and up arrows 60 s.

If the table (mapping.yaml) has changed since the recording, each message is converted to the message types
of the present table. Messages that have another meaning in the present table are reported and skipped
(exit code 1).

Example: roverlink recording replay run.mcap --speed 2 --as board --to 127.0.0.1:5000
"""

from __future__ import annotations

import argparse
import socket
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

from roverlink import topic_types
from roverlink.completion import complete, topics
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_destination,
    add_middleware,
    add_project,
    add_recording,
    documented_command,
    print_note,
    print_undelivered,
    project_folder,
    rate,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.keyboard import Keyboard
from roverlink.numerals import counted
from roverlink.runtime import Qos, SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.middleware import Middleware, open_middleware
from roverlink.runtime.net.carrier import way_to

if TYPE_CHECKING:
    from roverlink.runtime.recording.playback import Playback
    from roverlink.runtime.recording.reader import Recording
    from roverlink.runtime.recording.replaying import BoardReplay, RosReplay, Timed

_TICK_S = 0.025  # 40 a second, the rate at which rosbag2 publishes /clock
_SEEK_S = {"left": -10.0, "right": 10.0, "down": -60.0, "up": 60.0}
_CLOCK_END_NS = (1 << 31) * 1_000_000_000  # builtin_interfaces/msg/Time has 32 bits for the seconds

Send = Callable[["Timed"], None]
Tick = Callable[["Playback"], None]


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    add_recording(parser)
    parser.add_argument(
        "--as",
        dest="role",
        choices=("board", "ros"),
        default="board",
        help="board: send the recorded datagrams to a bridge, as the boards did; ros: publish the recorded topics, as "
        "the bridge did (default: %(default)s)",
    )
    add_destination(parser, "with --as board: address of the bridge")
    parser.add_argument(
        "--peer",
        metavar="NAME",
        help="with --as board: send only what this peer has sent, such as the one at the end of a line (default: all)",
    )
    topic = parser.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="TOPIC",
        help="with --as ros: publish only this topic; may be repeated",
    )
    complete(topic, topics)
    parser.add_argument(
        "--commands",
        action="store_true",
        help="with --as ros: also publish the topics that command boards. This moves the rover!",
    )
    parser.add_argument(
        "--clock",
        action="store_true",
        help="with --as ros: also publish the time of the recording on the topic /clock (rosgraph_msgs/msg/Clock), "
        "for nodes with the parameter use_sim_time",
    )
    parser.add_argument(
        "--speed", type=rate, default=1.0, metavar="X", help="replay X times as fast as recorded (default: 1)"
    )
    parser.add_argument(
        "--start",
        type=seconds,
        default=0.0,
        metavar="S",
        help="begin S seconds after the start of the recording (default: 0)",
    )
    parser.add_argument("--loop", action="store_true", help="replay again and again, until Ctrl-C")
    topic_types.add_wait(parser, "with --as ros: ")
    add_middleware(parser)
    parser.set_defaults(run=run, runs_until_stopped=True)


def run(arguments: argparse.Namespace) -> int:
    """Replay a recording to a bridge or to topics. The exit code is 1 if a message could not be replayed."""
    from roverlink.runtime.recording.playback import Playback
    from roverlink.runtime.recording.reader import Recording
    from roverlink.runtime.recording.replaying import BoardReplay, RosReplay

    if arguments.clock and arguments.role == "board":
        raise SetupError("--clock needs --as ros: a bridge stamps its messages with the present time")
    registry = load_project(project_folder(arguments.project))
    recording = Recording(arguments.recording)
    length = (recording.end - recording.start) / 1e9
    if arguments.start > length:
        raise SetupError(f"--start {arguments.start:g}: the recording has only {length:.1f} s")
    with ExitStack() as stack:
        ticks: list[Tick] = []
        if arguments.role == "board":
            replay: BoardReplay | RosReplay = BoardReplay(recording, registry, arguments.peer)
            send = _to_bridge(stack.enter_context(way_to(arguments.to, print_undelivered)).address, stack)
        else:
            wanted = {topic if topic.startswith("/") else f"/{topic}" for topic in arguments.topic}
            replay = ros = RosReplay(recording, registry, wanted, arguments.commands)
            middleware = stack.enter_context(open_middleware(arguments.middleware, topic_types.identity("replay")))
            if arguments.clock:
                ticks.append(_clock(middleware, recording))
            send = _to_topics(ros, middleware, arguments.wait, stack)
        for note in replay.notes:
            print_note(note)
        start = recording.start + int(arguments.start * 1e9)
        keyboard = stack.enter_context(Keyboard())
        if sys.stderr.isatty():
            stack.callback(_clear_line)
            ticks.append(_progress(recording.start, length, keyboard.available))
        playback = Playback(replay.messages, (recording.start, recording.end), start, arguments.speed)
        sent, took = _play(playback, send, ticks, keyboard, arguments.loop)
    print(f"replayed {counted(sent, 'datagram' if arguments.role == 'board' else 'message')} in {took:.1f} s")
    for reason, count in replay.refused.items():
        print_note(f"skipped {counted(count, 'message')}: {reason}")
    return FINDINGS if replay.refused else OK


def _play(playback: Playback, send: Send, ticks: Sequence[Tick], keyboard: Keyboard, loop: bool) -> tuple[int, float]:
    """Send all messages of a playback at their times. Return the number of sent messages, and the duration in seconds.

    ``ticks`` are called often, so that they can show or publish the position.
    """
    start, sent, next_tick = time.monotonic(), 0, 0.0
    while True:
        if (due := playback.due()) is None:
            if loop:
                playback.restart()
            if playback.due() is None:
                return sent, time.monotonic() - start
            continue
        if ticking := (now := time.monotonic()) >= next_tick:
            next_tick = now + _TICK_S
            for tick in ticks:
                tick(playback)
        # Neither a long time without a message, nor messages without a time between them, may keep the keys waiting.
        keys = keyboard.keys(max(0.0, min(due, _TICK_S))) if ticking or due > 0 else []
        for key in keys:
            if key == " ":
                playback.toggle_pause()
            elif key in _SEEK_S:
                playback.seek(_SEEK_S[key])
        if due <= 0 and not keys:
            send(playback.take())
            sent += 1


def _progress(start: int, length: float, keys: bool) -> Tick:
    """Return the tick that shows the position on the terminal; ``keys`` is true if it may also name the keys."""
    hint = "; space pauses, arrow keys seek" if keys else ""
    shown = ""

    def show(playback: Playback) -> None:
        nonlocal shown
        position = (playback.position - start) / 1e9
        share = f" ({position / length:.0%})" if length else ""
        state = ", paused" if playback.paused else ""
        line = f"{position:.1f} of {length:.1f} s{share}{state}{hint}"
        if line != shown:
            shown = line
            _clear_line()
            print(line, end="", file=sys.stderr, flush=True)

    return show


def _clear_line() -> None:
    # Go to the beginning of the line, and erase it (ECMA-48).
    print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def _clock(middleware: Middleware, recording: Recording) -> Tick:
    """Return the tick that publishes the time of the recording on ``/clock``.

    It is the time that the clock of the recording computer showed, because the stamps in the messages have it, too.
    """
    # rosbag2 publishes reliably, too: nodes subscribe with best effort (rclcpp::ClockQoS), which accepts both.
    publish = middleware.publisher("/clock", Clock, Qos(depth=1)).publish

    def tick(playback: Playback) -> None:
        now = recording.wall_at(playback.position)
        if not 0 <= now < _CLOCK_END_NS:
            raise SetupError("--clock: the recording has a time after 2038, which the messages of /clock cannot hold")
        publish([cdr.encode(Clock(Time.since_1970(now)))])

    return tick


def _to_bridge(destination: tuple[str, int], stack: ExitStack) -> Send:
    sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))

    def send(message: Timed) -> None:
        try:
            sock.sendto(message.data, destination)
        except OSError as error:
            raise SetupError(f"cannot send to {destination[0]}:{destination[1]}: {error.strerror}") from error

    return send


def _to_topics(replay: RosReplay, middleware: Middleware, wait: float, stack: ExitStack) -> Send:
    if replay.left_out:
        print_note(
            f"skipped because they command the rover: {', '.join(replay.left_out)}; --commands publishes them",
        )
    publishers = {
        topic: middleware.publisher(topic, endpoint.message_type, endpoint.qos)
        for topic, endpoint in replay.endpoints.items()
    }
    topic_types.wait_for_subscriber(publishers.values(), wait, "none of the topics has a subscriber yet")
    # Registered after the middleware, so it runs before the middleware closes.
    stack.callback(time.sleep, topic_types.FLUSH_S)

    def send(message: Timed) -> None:
        publishers[message.topic].publish([message.data])

    return send
