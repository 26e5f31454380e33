"""Commands that start a bridge of their own, with rclpy as with dds."""

from __future__ import annotations

import json
import re

import pytest
from needs import NO_RCLPY
from programs import Start

pytest.importorskip("rclpy", reason=NO_RCLPY)


def test_every_message_crosses_in_the_demo(done: Start, middleware: str) -> None:
    """In a few seconds all messages cross, those of the camera process among them."""
    code, output, errors = done("demo", "--seconds", 5, "--middleware", middleware)  # type: ignore[misc]
    assert code == 0, f"{output}\n{errors}"
    assert "21 of 21 messages were bridged" in output
    assert re.search(r"located itself in [1-9]\d* frames", output)


def test_the_sums_of_a_simulation_agree(done: Start, middleware: str) -> None:
    """Each datagram of a rough simulation is accounted for, and each command of a ROS 2 node arrives."""
    code, output, errors = done(  # type: ignore[misc]
        "simulate", "--bridge", middleware, "--scenario", "malformed", "--seconds", 3, "--json"
    )
    assert code == 0, f"{output}\n{errors}"
    said = json.loads(output)
    assert said["commands"] > 0, said
