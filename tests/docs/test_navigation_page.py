"""docs/navigation.md: its mission and its tables are true, and the row that it proposes carries the progress."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
import yaml
from needs import NO_OPENCV
from page import ROOT, Reader, blocks

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.mission.mission_file import GoalRules, read_mission
from roverlink.mission.mission_rules import State

_PAGE = ROOT / "docs" / "navigation.md"
_TEXT = _PAGE.read_text(encoding="utf-8")
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


def _keys(first_cell: str) -> list[str]:
    """Keys in the first column of the table whose heading starts with a text."""
    table = _TEXT.partition(f"\n| {first_cell} |")[2].partition("\n\n")[0]
    return [name.partition(":")[0] for name in re.findall(r"^\| `([^`]+)` \|", table, re.MULTILINE)]


@pytest.mark.slow
def test_the_proposed_row_carries_the_progress_of_missions(tmp_path: Path) -> None:
    """In a copy of the project: the lint accepts the row, and every state is published as its message."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "Report missions to the basestation"))
        command = [sys.executable, "-c", _PUBLISH]
        done = subprocess.run(command, cwd=reader.project, capture_output=True, text=True, env=reader.environment)
    assert done.returncode == 0, done.stderr
    assert [json.loads(line) for line in done.stdout.splitlines()] == [
        [number, 2, 3, 1.5] for number in range(len(State))
    ]


def test_the_mission_of_the_page_can_be_read(tmp_path: Path) -> None:
    """With the landmarks of the page about markers."""
    (mission,) = (block.text for block in blocks(_PAGE) if block.text.startswith("# mission.yaml"))
    (tmp_path / "mission.yaml").write_text(mission)
    (tmp_path / "landmarks.yaml").write_text((ROOT / "docs" / "vision" / "landmarks.yaml").read_text())
    assert len(read_mission(tmp_path / "mission.yaml").goals) == 3


def test_every_rule_stands_there() -> None:
    """In the table, with its default."""
    assert sorted(_keys("rule, at the top or in a goal")) == sorted(
        "on_failure" if field.name == "stops" else field.name for field in fields(GoalRules)
    )


def test_every_argument_of_the_launch_file_stands_there() -> None:
    """In the table of arguments, in any order."""
    whole = yaml.safe_load((ROOT / "navigation" / "launch" / "slam_launch.yaml").read_text(encoding="utf-8"))
    declared = [entry["arg"]["name"] for entry in whole["launch"] if "arg" in entry]
    assert sorted(_keys("argument")) == sorted(declared)
