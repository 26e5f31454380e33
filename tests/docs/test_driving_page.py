"""docs/driving.md: its steps lead where they say, its parameters are the node's, and the lint accepts its fields."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import needs_dds
from page import ROOT, Reader, blocks

from roverlink.drive.drive_parameters import PARAMETERS
from roverlink.driving.drive_control import State

_PAGE = ROOT / "docs" / "driving.md"


@needs_dds
@pytest.mark.slow
def test_a_velocity_reaches_the_board_step_by_step(tmp_path: Path) -> None:
    """In a copy of the project, over DDS."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "Try it"))


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
