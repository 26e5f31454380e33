"""Start and tail of a program that is a ROS 2 node: its arguments, its project, its connection, and its JSON lines."""

from __future__ import annotations

import argparse
import json
import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager

from roverkit.node.ros_connection import RosConnection

from roverlink.console import node_logger, project_folder
from roverlink.node_log import publish_log
from roverlink.runtime import Registry
from roverlink.runtime.middleware import NodeParameters
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.ros_arguments.ros_args import RosArguments


def node_arguments(arguments: argparse.Namespace, name: str) -> tuple[RosArguments, logging.Logger]:
    """Return the arguments after ``--ros-args``, and the logger of the node; ``name`` is its default name."""
    ros = ros_args.parse(arguments.ros_args, name)
    return ros, node_logger(ros.node.name, ros.log_level if ros.logs_to_console else None)


def project_registry(arguments: argparse.Namespace) -> Registry:
    """Return the registry of the project that the options select. Raises `NoProjectError` if there is none."""
    from roverlink.generated_code import load_project  # only here: the help needs none of it

    return load_project(project_folder(arguments.project))


@contextmanager
def connected(
    ros: RosArguments, middleware: str, logger: logging.Logger, parameters: NodeParameters | None = None
) -> Iterator[RosConnection]:
    """Connect a node over a middleware (see `open_middleware`), and publish its log, until the context ends."""
    with ExitStack() as stack:
        connection = RosConnection(ros, middleware, stack, logger.warning, parameters)
        stack.enter_context(publish_log(logger, connection.middleware, ros))
        yield connection


def json_printer(wanted: bool) -> Callable[[Mapping[str, object]], None]:
    """Return a function that prints an object as one line of JSON, or prints nothing if that is not wanted."""
    return lambda entry: print(json.dumps(entry), flush=True) if wanted else None
