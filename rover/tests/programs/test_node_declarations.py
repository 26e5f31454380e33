"""The nodes of the programs are as they are declared, and the declarations can be read without optional packages."""

from __future__ import annotations

import importlib
import logging
import os
import re
import subprocess
import sys
from argparse import ArgumentParser
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from roverkit.driving.drive_declaration import NODE as DRIVE
from roverkit.driving.drive_node import Driving
from roverkit.driving.drive_parameters import DriveParameters
from roverkit.driving.drive_rows import DriveRows
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.odometry_declaration import NODE as ODOMETRY
from roverkit.odometry.odometry_parameters import OdometryParameters
from roverkit.odometry.odometry_rows import OdometryRows
from roverkit.odometry.wheel_odometry_node import OdometryNode

from generated.registry import REGISTRY
from roverlink.command_line import ELSEWHERE, command_line
from roverlink.nodes import Direction, ExtraTopics, NodeDeclaration, RowTopic, Topic
from roverlink.nodes.installed import declared_nodes
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Publisher
from roverlink.runtime.middleware.memory import MemoryMiddleware, MemorySubscription
from roverlink.runtime.ros_arguments import ros_args

_ROVERKIT = Path(__file__).parents[2] / "roverkit"
_OPTIONAL = ("av", "cv2", "gtsam", "jax", "numpy", "onnxruntime", "scipy")


def _commands(parser: ArgumentParser, words: tuple[str, ...] = ()) -> dict[str, ArgumentParser]:
    """Return the commands below a command that have no commands themselves, by their words with ``_`` between them."""
    groups = [action.choices for action in parser._actions if isinstance(action.choices, dict)]
    if not groups:
        return {"_".join(words): parser}
    return {
        name: found
        for group in groups
        for word, below in group.items()
        for name, found in _commands(below, (*words, word)).items()
    }


@pytest.mark.slow
def test_each_command_that_takes_ros_arguments_declares_its_node() -> None:
    """No other command does, and no module that only helps."""
    found = {
        name
        for command in ELSEWHERE["roverkit"]
        for name, parser in _commands(command_line([command])).items()
        if parser.get_default("takes_ros_args")
    }
    assert found == set(declared_nodes())


@pytest.mark.slow
def test_declarations_need_no_optional_package() -> None:
    """check-launch reads them where neither OpenCV nor GTSAM is installed."""
    script = (
        f"import sys; sys.modules.update(dict.fromkeys({_OPTIONAL})); "
        "from roverlink.nodes.installed import declared_nodes; print(len(declared_nodes()))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.stderr, done.stdout) == ("", f"{len(declared_nodes())}\n")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts threads in /proc")
def test_numpy_starts_no_threads_in_programs() -> None:
    """Its threads spin between products of small matrices, which takes the processor from the other programs."""
    product = "import roverkit, numpy, os; numpy.ones((600, 600)) @ numpy.ones((600, 600))"
    words = [sys.executable, "-c", f"{product}; print(len(os.listdir('/proc/self/task')))"]
    unset = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    assert subprocess.run(words, capture_output=True, text=True, check=True, env=unset).stdout == "1\n"


def test_programs_open_declared_topics_only() -> None:
    """No program opens a topic by its name, and each declared topic belongs to a node. Users name those with images."""
    opening = re.compile(r"middleware\.(?:publisher|subscribe)\(")
    assert [path for path in _ROVERKIT.rglob("*.py") if opening.search(path.read_text(encoding="utf-8"))] == []
    for path in _ROVERKIT.glob("*/*_declaration*.py"):
        names = vars(importlib.import_module(f"roverkit.{path.parent.name}.{path.stem}")).values()
        topics = {topic for node in names if isinstance(node, NodeDeclaration) for topic in node.topics}
        assert {one for one in names if isinstance(one, Topic | RowTopic | ExtraTopics)} <= topics, path


class _Recorded(MemoryMiddleware):
    """Middleware that remembers what a node opens."""

    def __init__(self) -> None:
        super().__init__()
        self.opened: set[tuple[Direction, str, str, Qos]] = set()

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        self.opened.add((Direction.PUBLISHED, topic, message_type.__msgtype__, qos))
        return super().publisher(topic, message_type, qos)

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, *given: Any, **named: Any
    ) -> MemorySubscription:
        self.opened.add((Direction.RECEIVED, topic, message_type.__msgtype__, qos))
        return super().subscribe(topic, message_type, qos, *given, **named)


@pytest.mark.parametrize("node", [DRIVE, ODOMETRY], ids=lambda node: node.name)
def test_a_program_opens_all_that_it_declares(node: NodeDeclaration) -> None:
    """Its topics have the declared directions, types and QoS. One whose publisher decides the type waits for that."""
    ros, logger = ros_args.parse([], node.name), logging.getLogger("test")
    with ExitStack() as held:
        middleware = held.enter_context(_Recorded())
        connection = RosConnection.over(middleware, ros, logger.warning)
        if node is DRIVE:
            Driving(connection, DriveRows(REGISTRY), DriveParameters(ros, logger), logger, as_json=False).receive()
        else:
            rows, parameters = OdometryRows(REGISTRY), OdometryParameters(ros, logger)
            OdometryNode(connection, rows, parameters, logger, as_json=False).receive()
        declared = [one.of(REGISTRY) if isinstance(one, RowTopic) else one for one in node.topics]
        assert middleware.opened == {
            (one.direction, ros.topic(one.name), *one.type_names, one.qos) for one in declared if one.qos
        }
