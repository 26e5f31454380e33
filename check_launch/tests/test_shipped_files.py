"""The launch files of this repository: they pass the check, and it finds every mistake that is put into them."""

from __future__ import annotations

import random
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from check_launch.catalogue.catalogue_files import read_catalogue
from check_launch.catalogue.facts import Catalogue
from check_launch.expansion.launch_context import Packages
from check_launch.own_programs import with_own_programs
from check_launch.rules.checking import Checker
from shipped_files import LAUNCH_FILES

_ROOT = Path(__file__).parents[2]
_WHOLE = "rover/navigation/launch/slam.launch.py"
_TOPICS = (
    r"from: ([\w/]+), to: ([\w/]+)\}",
    r"topic:([\w/]+) ",
    r"^    (?:Depth |Marker )?Topic: .*Value: ([\w/]+)\}",
    r"(?:odom_topic|costmap_topic|footprint_topic|odom\d|imu\d|pose\d): ([\w/]+)$",
)
_OF_ALL = ("tf", "tf_static", "/tf", "/tf_static")

Findings = set[tuple[str, str, int, str]]


class Project:
    """A copy of the launch files, which tests may spoil."""

    def __init__(self, folder: Path, catalogue: Catalogue) -> None:
        self.folder, self._catalogue = folder, catalogue
        self._before: dict[str, Findings] = {}

    def findings(self, launch_file: str) -> Findings:
        """Return rule, file, line and message of all findings that are no hints."""
        checker = Checker(self._catalogue, Packages([self.folder]))
        found = checker.check([self.folder / launch_file], {}).findings
        return {
            (one.rule.id, one.span.file, one.span.line, one.message) for one in found if one.severity.value != "hint"
        }

    def spoiled(self, file: str, start: int, end: int, new: str, launch_file: str) -> Findings:
        """Return the findings that a change of one text in a file adds."""
        path = self.folder / file
        text = path.read_text(encoding="utf-8")
        if launch_file not in self._before:
            self._before[launch_file] = self.findings(launch_file)
        path.write_text(text[:start] + new + text[end:], encoding="utf-8")
        try:
            return self.findings(launch_file) - self._before[launch_file]
        finally:
            path.write_text(text, encoding="utf-8")


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Project:
    """A copy of the project's launch files and table."""
    for name in ("rover/navigation", "generated/ros"):
        shutil.copytree(_ROOT / name, tmp_path / name)
    shutil.copy(_ROOT / "mapping.yaml", tmp_path)
    monkeypatch.chdir(tmp_path)
    return Project(tmp_path, with_own_programs(read_catalogue("humble"), tmp_path / "mapping.yaml"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "launch_file",
    sorted(
        path.relative_to(_ROOT).as_posix()
        for folder in ("rover/navigation/launch", "generated/ros/comms/launch")
        for path in (_ROOT / folder).iterdir()
        if path.name != "slam_launch.yaml"  # it is a part of slam.launch.py, the whole rover
    ),
)
def test_shipped_launch_files_pass(launch_file: str, project: Project) -> None:
    """No launch file has findings, whatever its arguments are; in the whole rover, no topic and no frame is missing."""
    assert project.findings(launch_file) == set()


def _keys(project: Project) -> list[tuple[str, int, int, str]]:
    """Return file, start, end and text of each key of a parameter, and of each name of a node."""

    def walk(node: yaml.Node | None, in_parameters: bool) -> Iterator[yaml.ScalarNode]:
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            if key.value == "ros__parameters":
                yield from walk(value, True)
            else:
                if key.value != "/**":
                    yield key
                yield from walk(value, in_parameters)

    return [
        (file, key.start_mark.index, key.end_mark.index, key.value)
        for file in LAUNCH_FILES
        for key in walk(yaml.compose((project.folder / file).read_text(encoding="utf-8")), False)
    ]


def _edited(text: str, at: int, kind: int) -> str:
    """Return a text with one letter left out, replaced, inserted, or swapped with the next one."""
    other = "x" if text[at] != "x" else "y"
    return (
        text[:at] + text[at + 1 :],
        text[:at] + other + text[at + 1 :],
        text[:at] + "q" + text[at:],
        text[:at] + text[at + 1 : at + 2] + text[at] + text[at + 2 :],
    )[kind]


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, pytest.param(None, marks=pytest.mark.exhaustive)])
def test_misspelt_keys_are_found(count: int | None, project: Project) -> None:
    """Some keys of the shipped parameter files, or all of them, with one wrong letter each give a finding."""
    chosen = random.Random(25)  # noqa: S311  # no secret: the same letters in each run
    keys = _keys(project)
    names = {text for _, _, _, text in keys}
    missed = []
    for file, start, end, text in keys if count is None else chosen.sample(keys, count):
        first = len("/**/") if text.startswith("/**/") else 0
        new = _edited(text, chosen.randrange(first, len(text)), chosen.randrange(4))
        while new in names or new.strip("/") == text.strip("/"):  # it is a key, too
            new = _edited(text, chosen.randrange(first, len(text)), chosen.randrange(4))
        if not project.spoiled(file, start, end, new, LAUNCH_FILES[file]):
            missed.append(f"{file}: {text} -> {new}")
    assert missed == []


@pytest.mark.exhaustive
@pytest.mark.parametrize("new", ["{}x", "other/name"])
def test_every_renamed_topic_is_found(new: str, project: Project) -> None:
    """Each topic in the launch files and configurations of the rover, with another name, gives a finding."""
    smoother = project.folder / "rover/navigation/config/navigation.yaml"  # it reads odometry in a closed loop only
    smoother.write_text(smoother.read_text(encoding="utf-8").replace("OPEN_LOOP", "CLOSED_LOOP"), encoding="utf-8")
    places = [
        (path.relative_to(project.folder).as_posix(), *match.span(group), match[group])
        for folder in ("launch", "config", "rviz")
        for path in sorted((project.folder / "rover" / "navigation" / folder).iterdir())
        for pattern in _TOPICS
        for match in re.finditer(pattern, path.read_text(encoding="utf-8"), re.MULTILINE)
        for group in range(1, match.re.groups + 1)
        # A topic below the node's own name leads to nowhere on purpose, whatever its name is.
        if match[group] not in _OF_ALL and not match[group].startswith("rtabmap/")
    ]
    assert [
        f"{file}: {text} -> {new.format(text)}"
        for file, start, end, text in places
        if not project.spoiled(file, start, end, new.format(text), _WHOLE)
    ] == []
