"""Commands that start a bridge of their own, with rclpy as with dds."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest
from needs import NO_RCLPY
from programs import Start

if TYPE_CHECKING:
    from judge import Bridge  # importing it skips a module where there is no rclpy

pytest.importorskip("rclpy", reason=NO_RCLPY)


def test_every_message_crosses_in_the_demo(done: Start) -> None:
    """In a few seconds all messages cross, those of the camera process among them."""
    code, output, errors = done("demo", "--seconds", 5, "--middleware", "rclpy")  # type: ignore[misc]
    assert code == 0, f"{output}\n{errors}"
    assert "21 of 21 messages bridged" in output
    assert re.search(r"located the rover in [1-9]\d* frames", output)


def test_the_sums_of_a_simulation_agree(done: Start) -> None:
    """Each datagram of a rough simulation is accounted for, and each command of a ROS 2 node arrives."""
    words = ("simulate", "--bridge", "rclpy", "--scenario", "malformed", "--seconds", 3, "--json")
    code, output, errors = done(*words)  # type: ignore[misc]
    assert code == 0, f"{output}\n{errors}"
    assert json.loads(output)["commands"] > 0, output


def test_top_shows_a_bridge_of_another_process(bridge: Callable[..., Bridge], done: Start) -> None:
    """An rclpy node of its own hears the state on /diagnostics, counts included, whatever middleware the bridge has."""
    running = bridge()
    running.send(imu_info={})
    code, output, errors = done("top", "--once", "--json", "--middleware", "rclpy", "--timeout", 30)  # type: ignore[misc]
    assert code in (0, 1), f"{output}\n{errors}"  # 1 if rclpy was so slow to start that the board counts as silent
    page = json.loads(output)
    row = next(row for row in page["rows"] if row["name"] == "imu_info")
    assert (page["node"]["pid"], row["topic"], row["count"]) == (running.program.pid, "imu_data", 1)
