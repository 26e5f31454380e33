"""Sections of the documentation that a reader follows, to the letter, in a copy of the project."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from needs import NO_OPENCV, needs_dds
from page import ROOT, Reader, blocks

_NEEDS_OPENCV = pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)
_SECTIONS = [
    pytest.param("docs/adding-a-message.md", "", marks=needs_dds),
    pytest.param("README.md", "Add a message", marks=needs_dds),
    pytest.param("docs/driving.md", "Try it", marks=needs_dds),
    ("docs/driving.md", "Add a speed and a turn to the commands"),
    ("docs/rocks.md", "Add a camera and a reason to the messages"),
    pytest.param("docs/vision.md", "Try it", marks=[needs_dds, _NEEDS_OPENCV]),
]
_PUBLISH = """
import json, pathlib
from roverlink.generated_code import load_project
from roverlink.mission.mission_row import progress_publisher
from roverlink.mission.mission_rules import Report, State
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware.memory import MemoryMiddleware

registry, middleware, heard = load_project(pathlib.Path.cwd()), MemoryMiddleware(), []
row = registry.by_name["mission_progress"]
middleware.subscribe("/mission_progress", row.message_type, row.route.qos, heard.extend)
publish = progress_publisher(middleware, registry, lambda topic: f"/{topic}", 3)
for state in State:
    publish(Report(state, 2, "", 1.5))
for data in heard:
    message = cdr.decode(row.message_type, data)
    print(json.dumps([message.state, message.goal, message.goals, message.distance]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("page", "section"), _SECTIONS)
def test_a_page_can_be_followed_step_by_step(page: str, section: str, tmp_path: Path) -> None:
    """Every file, edit and command of a page or of its section, in order, shows what the page shows."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(ROOT / page, section))


@pytest.mark.slow
@_NEEDS_OPENCV
def test_the_proposed_row_carries_the_progress_of_missions(tmp_path: Path) -> None:
    """The lint accepts the row of docs/navigation.md, and every state is published as its message."""
    from roverlink.mission.mission_rules import State

    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(ROOT / "docs" / "navigation.md", "Report missions to the basestation"))
        command = [sys.executable, "-c", _PUBLISH]
        done = subprocess.run(command, cwd=reader.project, capture_output=True, text=True, env=reader.environment)
    assert done.returncode == 0, done.stderr
    published = [json.loads(line) for line in done.stdout.splitlines()]
    assert published == [[number, 2, 3, 1.5] for number in range(len(State))]
