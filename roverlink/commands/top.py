"""Show the state of a running bridge live: message rates, time since the last message, drops, queues.

Show the state of all running bridges live, to see which messages arrive and which are lost. The command
reads the topic /diagnostics, so a bridge may run on any machine of the same ROS 2 domain.

The first line has the worst of all that is wrong: with the bridge, its peers and boards, their addresses,
protos and losses, the stops and the rows. WAITING is a peer or board that has not spoken yet. The lines below
it say what to do, and what else is wrong. The table has these columns for each row of mapping.yaml:
  level    OK; WARN: too few messages, a loss, other protos, or a QoS that does not match; SILENT: expected
           messages do not come, or the peer or board is silent; ERROR: messages are dropped, and none is
           bridged; STOP: the bridge tells the peer to stop; REST: the same before the first command; IDLE: no
           message yet
  rate     messages a second, in the last two seconds
  min      messages a second that the table expects at least (key expect_rate)
  age      time since the last message
  count    messages bridged since the start
  dropped  messages that were not bridged
  stops    stops that the bridge sent because the topic was silent (table key deadman)
  message  reason for the level; on a narrow terminal it stands below the table, for the selected row
Several bridges are shown side by side if the terminal is wide enough.

Keys:
  up, down, page up, page down, home, end (or k, j, g, G)   select a row, and scroll
  s, S   sort by the next or the last of: number, name, level, rate, age, dropped
  /      show only rows with a text in their name, topic, direction or level
  p      show only rows with a problem: another level than OK, IDLE and REST, or drops
  Esc    show all rows again
  Tab    select the next bridge
  q      quit

Example: roverlink top
"""

from __future__ import annotations

import argparse
import contextlib
import json
import logging
import queue
import sys
import time
from collections.abc import Sequence
from typing import Any

from roverlink import link_page, topic_types
from roverlink.console import FINDINGS, OK, Subparsers, add_middleware, documented_command, print_note, seconds
from roverlink.heard_bridges import QUIET_S, HeardBridges
from roverlink.keyboard import Keyboard
from roverlink.link_judgement import worst_of
from roverlink.link_page.followed_bridges import FollowedBridges
from roverlink.link_page.live_page import LivePage
from roverlink.runtime import SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.interfaces.rcl_interfaces import Log
from roverlink.runtime.middleware import Middleware, open_middleware, rosout
from roverlink.runtime.monitoring import diagnostic_array
from roverlink.runtime.ros_arguments import ros_args

_REFRESH_S = 0.25
_MOST_ON_PAGE = 16  # bridges
_HEAR_S = 1.5  # each bridge publishes its state once a second


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "--node",
        action="append",
        default=[],
        metavar="NAME",
        help="show only the bridge whose node has this name, such as udp_forwarder or /rover/udp_forwarder; may be "
        "repeated (default: all bridges)",
    )
    parser.add_argument(
        "--once",
        action="store_true",
        help="show the state once and exit: with code 0 if the first line of each bridge says OK and no two bridges "
        "have the same name, else with 1 (a peer or board that has not spoken yet is not OK)",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        help="print the state as a JSON object every second, on one line for each bridge; with --once, print one "
        "object for each bridge",
    )
    link_page.add_options(parser, "--web", "acknowledge alarms for all browsers")
    parser.add_argument(
        "--timeout", type=seconds, default=10.0, metavar="S", help="wait at most S seconds for a bridge (default: 10)"
    )
    add_middleware(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Show the state of bridges until Ctrl-C or the key q, or only once; or on a web page.

    The exit code is 1 if no bridge is found. With ``--once`` it is also 1 if the state is not OK. Raises `SetupError`
    if options exclude each other, or if the live view has no terminal.
    """
    link_page.check_options("--web", arguments.web, arguments.page_token)
    if arguments.web is not None:
        if arguments.once or arguments.json:
            raise SetupError("--web cannot be combined with --once or --json; run `roverlink top` twice")
    elif not (arguments.once or arguments.json or sys.stdout.isatty()):
        raise SetupError("the output is not a terminal; print the state with `roverlink top --once` or `--json`")
    arrived: queue.Queue[bytes] = queue.Queue()
    heard = HeardBridges(arguments.node, most=None if arguments.web is None else _MOST_ON_PAGE)

    def keep(messages: Sequence[bytes]) -> None:
        for message in messages:
            arrived.put(message)

    ros = ros_args.parse(arguments.ros_args, topic_types.identity("top").name)
    topic = ros.topic(diagnostic_array.TOPIC)
    with open_middleware(arguments.middleware, ros.node) as middleware:
        middleware.subscribe(topic, DiagnosticArray, diagnostic_array.QOS, keep)
        state = _next_state(arrived, heard, min(_HEAR_S, arguments.timeout))
        if state is None and arguments.timeout > _HEAR_S:
            print_note(f"waiting for a bridge, at most {arguments.timeout:g} s")
            state = _next_state(arrived, heard, arguments.timeout - _HEAR_S)
        if state is None:
            bridges = " or ".join(f"named {name!r}" for name in arguments.node)
            print_note(
                f"no messages of a bridge{bridges and f' {bridges}'} on {topic} within "
                f"{arguments.timeout:g} s; check that the bridge runs in this ROS 2 domain, without --no-diagnostics",
            )
            return FINDINGS
        if arguments.web is not None:
            return _serve(arrived, heard, arguments, middleware)
        if arguments.once:
            return _show(arrived, heard, arguments.json)
        return _print_json(arrived, heard, state) if arguments.json else _follow(arrived, heard)


def _show(arrived: queue.Queue[bytes], heard: HeardBridges, as_json: bool) -> int:
    """Show the states of all bridges once, and return the exit code."""
    _hear_all(arrived, heard)
    if as_json:
        for bridge in heard.bridges:
            print(json.dumps(_with_worst(bridge.state), indent=2))
    else:
        from rich.console import Console  # here: --help needs no rich

        from roverlink import top_screen

        console = Console()
        console.print(top_screen.printed(heard.bridges, console.width))
    warnings = heard.warnings()
    for warning in warnings:
        print_note(f"warning: {warning}")
    return (
        FINDINGS if warnings or any(worst_of(heard.state_now(bridge)).level != "OK" for bridge in heard.bridges) else OK
    )


def _print_json(arrived: queue.Queue[bytes], heard: HeardBridges, state: dict[str, Any]) -> int:
    told: set[str] = set()
    while True:
        print(json.dumps(_with_worst(state)), flush=True)
        _tell_new(heard.warnings(), told)
        while (next_state := _next_state(arrived, heard, QUIET_S)) is None:
            pass
        state = next_state


def _with_worst(state: dict[str, Any]) -> dict[str, Any]:
    return {"worst": worst_of(state)._asdict(), **state}


def _tell_new(warnings: Sequence[str], told: set[str]) -> None:
    for warning in set(warnings) - told:
        print_note(f"warning: {warning}")
        told.add(warning)


def _follow(arrived: queue.Queue[bytes], heard: HeardBridges) -> int:
    from rich.console import Console  # here: --help needs no rich
    from rich.live import Live

    from roverlink import top_screen

    view, console = top_screen.View(), Console()
    with Keyboard() as keyboard, Live(console=console, screen=True, auto_refresh=False) as live:
        while True:
            while not arrived.empty():
                heard.take(arrived.get())
            bridges = heard.bridges
            view.bridge = min(view.bridge, len(bridges) - 1)
            live.update(top_screen.live(bridges, heard, view, *console.size), refresh=True)
            for key in keyboard.keys(_REFRESH_S):
                if not view.press(key, [heard.state_now(bridge) for bridge in bridges]):
                    return OK


def _serve(
    arrived: queue.Queue[bytes], heard: HeardBridges, arguments: argparse.Namespace, middleware: Middleware
) -> int:
    """Show the bridges on a web page until Ctrl-C, with the logs that they publish on /rosout."""
    logger = logging.Logger("top", logging.INFO)
    logger.addHandler(logging.StreamHandler())  # the text alone, like all that this command prints
    page = LivePage(logger)
    bridges = FollowedBridges(heard, page)

    def take_log(messages: Sequence[bytes]) -> None:
        for message in messages:
            bridges.take_log(cdr.decode(Log, message))

    middleware.subscribe(rosout.TOPIC, Log, rosout.QOS, take_log)
    _hear_all(arrived, heard)  # so that a browser without a selection gets the first of all bridges
    told: set[str] = set()
    with contextlib.ExitStack() as stack:
        bridges.update()
        link_page.serve(page, arguments.web, arguments.page_token, stack, logger)
        while True:
            _tell_new(heard.warnings(), told)
            _next_state(arrived, heard, QUIET_S)
            bridges.update()


def _hear_all(arrived: queue.Queue[bytes], heard: HeardBridges) -> None:
    """Wait until each running bridge has published its state."""
    deadline = time.monotonic() + _HEAR_S
    while (left := deadline - time.monotonic()) > 0:
        _next_state(arrived, heard, left)


def _next_state(arrived: queue.Queue[bytes], heard: HeardBridges, seconds: float) -> dict[str, Any] | None:
    """Return the next state that a bridge publishes; None if no state comes within ``seconds`` seconds."""
    deadline = time.monotonic() + seconds
    # Other nodes publish on /diagnostics too, so a message may be from another node.
    while (left := deadline - time.monotonic()) > 0:
        try:
            message = arrived.get(timeout=left)
        except queue.Empty:
            return None
        if state := heard.take(message):
            return state
    return None
