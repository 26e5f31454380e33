"""docs/driving.md: its steps lead where they say, its parameters are the node's, and the lint accepts its fields."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from needs import needs_dds
from page import ROOT, Reader, blocks

from roverlink.drive.drive_parameters import PARAMETERS
from roverlink.driving.arcs import PlanarPose
from roverlink.driving.drive_control import DriveControl, DriveSettings, Localization, State

_PAGE = ROOT / "docs" / "driving.md"


@needs_dds
@pytest.mark.slow
def test_a_velocity_reaches_the_board_step_by_step(tmp_path: Path) -> None:
    """In a copy of the project, over DDS."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "Try it"))


@pytest.mark.slow
def test_the_lint_accepts_the_proposed_fields(tmp_path: Path) -> None:
    """In a copy of the project, compared with the message as it is."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "Add a speed and a turn to the commands"))


def test_the_page_lists_parameters_and_states() -> None:
    """Each parameter has its first value and its description."""
    page = _PAGE.read_text(encoding="utf-8")
    for name, (first, _, _) in PARAMETERS.items():
        shown = str(first).lower() if isinstance(first, bool) else first if isinstance(first, str) else f"{first:g}"
        assert f"| `{name}` | {shown} |" in page
    for state in State:
        assert f"| `{state.value}` |" in page


def _mean_speed(velocity: float, *, measured: bool) -> float:
    """The mean speed of a board that drives as fast as it can still stop at the end, with 0.5 m/s^2."""
    settings = DriveSettings()
    control = DriveControl(lambda: settings, lambda _: None)
    step, speed, left, now, driven = 0.01, 0.0, 0.0, 10**12, 0.0
    for tick in range(200):
        now += 100_000_000
        control.set_mode(True, now)
        control.drive(velocity, 0.0, now)
        if measured:
            control.localize(Localization(PlanarPose(), "odom", now, 0.0, speed), now)
        command = control.step(now)
        assert command is not None
        left = command.distance_to_go
        for _ in range(10):
            speed += min(max(min(0.5, math.sqrt(2 * 0.5 * left)) - speed, -2 * step), 0.5 * step)
            left = max(left - speed * step, 0.0)
            driven += speed * step if tick >= 100 else 0.0
    return driven / (100 * 0.1)


def test_the_speeds_of_a_simulated_board_are_those_of_the_table() -> None:
    """The measured speed makes the difference."""
    page = _PAGE.read_text(encoding="utf-8")
    rows = {
        name: [float(cell.split()[0]) for cell in cells.split("|")]
        for name, cells in re.findall(
            r"^\| (velocity|without the measured speed|with it) \| (.*) \|$", page, re.MULTILINE
        )
    }
    for name, measured in (("without the measured speed", False), ("with it", True)):
        speeds = [_mean_speed(velocity, measured=measured) for velocity in rows["velocity"]]
        assert speeds == pytest.approx(rows[name], abs=0.003)
