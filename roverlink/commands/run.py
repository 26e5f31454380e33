"""``roverlink run``: the node ``udp_forwarder``."""

from __future__ import annotations

import argparse
import json
import signal

from roverlink.console import OK, Subparsers, add_project, command, node_logger, project_folder
from runtime import NODE, Bridge, load_registry, parameters, ros_args
from runtime.middleware import NAMES, open_middleware

_STOPPING = (signal.SIGINT, signal.SIGTERM)


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "run",
        "bridge datagrams and topics, as the node udp_forwarder",
        "roverlink run --ros-args -p dst_ip:=10.0.0.7 -r imu_data:=imu/raw --log-level debug",
        "Bridge datagrams and topics, as the node udp_forwarder. SIGINT or SIGTERM stops it.\n"
        "After --ros-args: -p name:=value, --params-file FILE, -r from:=to, -r __ns:=/x, -r __node:=n, "
        "--log-level LEVEL.",
    )
    add_project(parser)
    parser.add_argument("--middleware", choices=NAMES, default="auto", help="auto: rclpy where it imports, else dds")
    parser.add_argument("--json", action="store_true", help="at the end, print the account as one JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Bridge until a signal comes; then exit code 0."""
    ros = ros_args.parse(arguments.ros_args, NODE)
    logger = node_logger(ros.node.name, ros.log_level)
    registry = load_registry(project_folder(arguments.project))
    settings = parameters.read(registry, ros.parameters)
    with open_middleware(arguments.middleware, ros.node, settings.values) as middleware:
        bridge = Bridge(registry, settings, middleware, ros.topic, logger)
        for number in _STOPPING:
            signal.signal(number, lambda *_: bridge.stop())
        with bridge:
            logger.info(
                "%s bridges %d messages on UDP port %d", ros.node.full_name, len(registry.handlers), bridge.port
            )
            bridge.run()
    for number in _STOPPING:
        signal.signal(number, signal.SIG_IGN)  # it is stopping; at its very end Python would obey them itself
    logger.info("%s", bridge.account.summary())
    if arguments.json:
        print(json.dumps(bridge.account.as_dict()))
    return OK
