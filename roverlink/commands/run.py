"""Run the bridge between UDP and ROS 2, as the node udp_forwarder.

Run the bridge between UDP and ROS 2, as the node udp_forwarder. The bridge publishes the datagrams of the
peers (boards, basestation) as messages on topics, and sends messages of other topics as datagrams to the
peers. mapping.yaml lists these messages. SIGINT (Ctrl-C), SIGTERM, SIGQUIT or a closed terminal (SIGHUP, unless
nohup ignores it) stops the bridge. The log is written to standard error; at the end it says how many datagrams
were received, published, sent and dropped.

All options must stand before --ros-args. After it, these arguments are known: -p NAME:=VALUE and
--params-file FILE (parameters such as dst_ip, the address of the peers, and listen_port),
-r FROM:=TO (remap a topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL.

Example: roverlink run --ros-args -p dst_ip:=10.0.0.7 -r imu_data:=imu/raw --log-level debug
"""

from __future__ import annotations

import argparse
import json
import logging
import signal
from contextlib import ExitStack
from pathlib import Path
from threading import Thread

from roverlink import observers
from roverlink.console import (
    LOG_FORMATS,
    OK,
    Subparsers,
    add_end,
    add_key_file,
    add_middleware,
    add_project,
    documented_command,
    node_logger,
    project_folder,
)
from roverlink.generated_code import changed_sources, load_project
from roverlink.node_log import publish_log
from roverlink.numerals import counted
from roverlink.observers import BridgeObservers
from roverlink.runtime import NODE, Bridge, Registry
from roverlink.runtime.bridge import service_manager
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.middleware import open_middleware
from roverlink.runtime.ros_arguments import parameters, ros_args
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock
from roverlink.runtime.ros_time.simulated_clock import TOPIC, SimulatedClock

_NAMED = 3  # changed files that a warning names
_STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGHUP)


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "--record",
        type=Path,
        metavar="FILE",
        help=f"record all topics and datagrams; FILE: {observers.RECORDING_HELP}",
    )
    add_options(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that `roverlink run` and `roverlink record` have in common to a parser."""
    add_project(parser)
    add_end(parser)
    add_middleware(parser)
    parser.add_argument(
        "--json",
        action="store_true",
        help="print a JSON object when the UDP port is open (with the node, the port and a hash of the table), and one "
        "at the end (with all counters)",
    )
    parser.add_argument(
        "--log-format",
        choices=LOG_FORMATS,
        default="ros",
        help="format of the log on standard error. ros: lines like those of other ROS 2 nodes; json: one JSON object "
        "per line (default: %(default)s)",
    )
    add_key_file(
        parser,
        "file with the keys of a peer or board that must sign its datagrams (table key `sign`); `roverlink link "
        "keygen` makes it; may be repeated",
    )
    observers.add_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the bridge until a signal in `_STOPPING` stops it; the exit code is then 0."""
    ros = ros_args.parse(arguments.ros_args, NODE)
    logger = node_logger(ros.node.name, ros.log_level if ros.logs_to_console else None, arguments.log_format)
    project = project_folder(arguments.project)
    registry = load_project(project, arguments.end)
    settings = parameters.read(registry, ros.parameters_in(parameters.declarations(registry), logger))
    live = LiveParameters(registry, settings, logger)
    links = open_links(registry, arguments.key_file, logger)
    with ExitStack() as stack:
        if links is not None:
            stack.enter_context(links)
        middleware = stack.enter_context(open_middleware(arguments.middleware, ros.node, live))
        published_log = stack.enter_context(publish_log(logger, middleware, ros))
        # Before the bridge: recorder and viewers have to wrap the middleware that the bridge gets.
        attached = BridgeObservers(arguments, registry, ros, settings, live, logger, stack)
        clock: Clock = SYSTEM_CLOCK
        if settings.use_sim_time:
            clock = published_log.enter_context(SimulatedClock(middleware, ros.topic(TOPIC), logger.warning))
        wrapped = attached.wrap(middleware)
        bridge = Bridge(registry, settings, wrapped, ros.topic, logger, attached.observers, links, clock)
        for number in _STOPPING:
            # A handler instead of KeyboardInterrupt, which would leave the bridge in the middle of a batch: `stop` lets
            # it handle what has arrived, and send the stops.
            if number != signal.SIGHUP or signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets it
                signal.signal(number, lambda *_: bridge.stop())
        live.on_change(bridge.change)
        # The log and the clock leave first, because the bridge closes the middleware.
        with bridge, attached.monitor(bridge, clock), published_log:
            stack.callback(lambda: _tell_account(bridge.account, logger, json_too=arguments.json))
            logger.info("%s", bridge.way)
            _announce(registry, ros.node.full_name, bridge.port, logger, json_too=arguments.json)
            # Beside the bridge, which need not wait for it.
            comparison = Thread(
                target=_warn_of_changes, args=(project, registry, bridge.account, logger), name="changes"
            )
            comparison.start()
            stack.callback(comparison.join)
            service_manager.notify(service_manager.READY)
            bridge.run()
            service_manager.notify(service_manager.STOPPING)
    return OK


def _tell_account(account: Account, logger: logging.Logger, *, json_too: bool) -> None:
    """Log the account at the end, also if a thread has failed. With ``json_too``, also print it as a JSON object."""
    for number in _STOPPING:
        signal.signal(number, signal.SIG_IGN)  # a second signal would end Python with an error code during shutdown
    logger.info("%s", account.summary())
    if json_too:
        print(json.dumps(account.as_dict()))


def _warn_of_changes(project: Path, registry: Registry, account: Account, logger: logging.Logger) -> None:
    """Warn that files have changed since the generated code was made, in the log and on /diagnostics."""
    if changed := changed_sources(project, registry):
        more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
        files = ", ".join(changed[:_NAMED]) + more
        text = f"the generated code is that of an earlier state of {files}; run `roverlink generate`"
        account.standing = {"generated code": text}
        logger.warning("%s", text)


def _announce(registry: Registry, node: str, port: int, logger: logging.Logger, *, json_too: bool) -> None:
    """Log that the bridge listens on a UDP port, with the fingerprint of the table (a hash).

    With ``json_too``, also print this as a JSON object on standard output. Two machines with equal fingerprints use the
    same table and the same message definitions.
    """
    messages, fingerprint = len(registry.handlers), registry.fingerprint
    logger.info("%s bridges %s on UDP port %d", node, counted(messages, "message"), port)
    if registry.own is not None:
        left_out = ", ".join(registry.own.left_out) or "none"
        logger.info(
            "this end of the link is %s; rows of other ends, which are left out: %s", registry.own.name, left_out
        )
    logger.info("fingerprint of table and schema: %s", fingerprint)
    if json_too:
        ready = {"node": node, "port": port, "messages": messages, "fingerprint": fingerprint}
        print(json.dumps(ready), flush=True)
