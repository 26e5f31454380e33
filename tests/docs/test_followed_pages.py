"""Sections of the documentation that a reader follows, to the letter, in a copy of the project."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest
from needs import NO_CAN, NO_OPENCV, needs_dds, needs_native
from page import ROOT, Reader, blocks

_NEEDS_OPENCV = pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)
_NEEDS_CAN = pytest.mark.skipif(not all(map(find_spec, ("can", "isotp", "msgpack"))), reason=NO_CAN)
_SECTIONS = [
    pytest.param("docs/adding-a-message.md", "", marks=[needs_dds, needs_native]),
    pytest.param("docs/can.md", "Try it without hardware", marks=[needs_dds, needs_native, _NEEDS_CAN]),
    pytest.param("README.md", "Add a message", marks=[needs_dds, needs_native]),
    pytest.param("docs/basestation.md", "ROS 2 at both ends", marks=[needs_dds, needs_native]),
    pytest.param("rover/README.md", "Example", marks=_NEEDS_OPENCV),
    pytest.param("rover/docs/driving.md", "Try it", marks=[needs_dds, needs_native]),
    ("rover/docs/driving.md", "Add a speed and a turn to the commands"),
    ("rover/docs/driving.md", "Add an odometer and a number to the reports"),
    ("rover/docs/rocks.md", "Add a camera and a number to the messages"),
    ("rover/docs/navigation.md", "Report missions to the basestation"),
    pytest.param("rover/docs/vision.md", "Try it", marks=[needs_dds, _NEEDS_OPENCV]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("page", "section"), _SECTIONS)
def test_a_page_can_be_followed_step_by_step(page: str, section: str, tmp_path: Path) -> None:
    """Every file, edit and command of a page or of its section, in order, shows what the page shows."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(ROOT / page, section))
