"""The tables, names and links of the documentation are complete, and those of the code."""

from __future__ import annotations

import importlib
import re
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path

import committed_tables
import pytest
import yaml
from case_file import USUAL_TABLE
from needs import NO_OPENCV
from page import ROOT
from roverkit.aruco import tracker_declaration
from roverkit.driving.drive_control import State

from roverlink.generator.emit import targets
from roverlink.generator.table import Table, reader
from roverlink.generator.table.parts import object_of
from roverlink.nodes import USE_SIM_TIME
from roverlink.runtime.core.errors import Reason

_NEEDS_OPENCV = pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)


def _page(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def _rows(page: str, heading: str) -> dict[str, list[str]]:
    """The rows of the table whose heading line starts with a text: other cells by the first one, without backquotes."""
    table = _page(page).partition(f"\n| {heading} |")[2].partition("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in table.splitlines()[2:]]
    return {first.strip("` "): others for first, *others in rows}


@pytest.mark.parametrize("page", committed_tables.PAGES, ids=lambda page: page.name)
def test_the_tables_made_from_declarations_are_current(page: Path) -> None:
    """They are what `make docs-reference` writes, and have every key of the table."""
    text = page.read_text(encoding="utf-8")
    assert text == committed_tables.current(text), "run: make docs-reference"
    if page.name == "mapping.md":
        assert sorted(committed_tables.documented_keys(text)) == sorted(object_of(Table).keys)


def test_the_defaults_are_those_of_the_reader(tmp_path: Path) -> None:
    """A table without any optional key reads as docs/mapping.md says."""
    (tmp_path / "mapping.yaml").write_text(USUAL_TABLE, encoding="utf-8")
    table = reader.read(tmp_path / "mapping.yaml", [])
    row, peer = table.rows[0], table.peers[0]
    rows = re.findall(r"^\| `(.*?)` \| .* \| .* \| (.*?) \|$", _page("docs/mapping.md"), re.MULTILINE)
    documented = {key: default.split(",")[0].strip("`") for key, default in rows}
    read = {
        "envelope.owner": table.envelope.owner,
        "peers.<peer>.parameter": peer.parameter,
        "peers.<peer>.port": str(peer.port),
        "peers.<peer>.strip_trailing_zeros": str(peer.strip_trailing_zeros).lower(),
        "messages[].queue": str(row.profile.depth),
        "messages[].priority": str(row.priority),
    }
    read |= {f"messages[].qos.{key}": str(getattr(row.profile, key)) for key in _QOS}
    assert {key: documented[key] for key in read} == read
    assert row.ros == "A"
    nothing = {"proto.exclude": table.proto.exclude, "retired": table.retired, "enums": table.enums, "lint": table.lint}
    nothing |= {f"messages[].{key}": getattr(row, key) for key in _ABSENT} | {"peers.<peer>.max_size": peer.max_size}
    assert not any(nothing.values())
    assert {key: documented[key] for key in nothing} == dict.fromkeys(nothing, "none")


_QOS = ("depth", "reliability", "durability", "history")
_ABSENT = ("lint", "deadman", "max_rate", "fields", "ignore", "forward")


_REASONS = [reason.value for reason in Reason]
_JUDGEMENT = (ROOT / "roverlink/link_judgement.py").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("page", "heading", "names"),
    [
        ("rover/docs/driving.md", "state", [state.value for state in State]),
        (
            "rover/docs/vision-reference.md",
            "parameter",
            [one.name for one in (*tracker_declaration.NODE.parameters, USE_SIM_TIME)],
        ),
        ("docs/field-day.md", "alarm", re.findall(r'yield (?:\(\s*)?f?"(\w+)', _JUDGEMENT)),
        ("docs/targets.md", "target", targets.names()),
        ("docs/nothing-arrives.md", "reason", _REASONS),
        ("docs/security.md", "counted as", _REASONS[_REASONS.index("unsigned") : _REASONS.index("ahead") + 1]),
    ],
)
def test_a_table_lists_what_the_code_has(page: str, heading: str, names: list[str]) -> None:
    """Each state, parameter, kind of alarm, target that comes with the project, and reason to drop a datagram."""
    listed = {name for cell in _rows(page, heading) for name in re.findall(r"(?:^|, )`?(\w+)", cell)}
    assert listed == set(names)


@_NEEDS_OPENCV
def test_rocks_lists_the_reasons() -> None:
    """In the table, and in the enum of the message."""
    from roverkit.rocks.unmeasurable import Unmeasurable

    from generated.messages import BasestationRockMeasureResult

    page, reasons = _page("rover/docs/rocks.md"), [reason.value for reason in Unmeasurable]
    assert re.findall(r"^\| `(\w+)` \| [^|]* \|$", page, re.MULTILINE) == reasons
    failures = {name for name in vars(BasestationRockMeasureResult) if name.startswith("ROCK_MEASURE_FAILURE_")}
    assert failures == {f"ROCK_MEASURE_FAILURE_{reason.upper()}" for reason in ("none", *reasons)}


@_NEEDS_OPENCV
def test_navigation_lists_rules_and_arguments() -> None:
    """Every rule of a mission and every argument of the launch file, in any order."""
    from roverkit.mission.mission_file import GoalRules

    page = "rover/docs/navigation.md"
    rules = ["on_failure" if one.name == "stops" else one.name for one in fields(GoalRules)]
    listed = [rule.partition(":")[0] for rule in _rows(page, "rule, at the top or in a goal")]
    assert sorted(listed) == sorted(rules)
    launch = yaml.safe_load(_page("rover/navigation/launch/slam_launch.yaml"))["launch"]
    declared = [entry["arg"]["name"] for entry in launch if "arg" in entry]
    assert sorted(_rows(page, "argument")) == sorted(declared)


def test_the_readme_is_short() -> None:
    """At most 7 kB: what one needs to decide, and where to go on."""
    assert len(_page("README.md").encode()) <= 7000


def test_what_development_names_exists() -> None:
    """`module:name` can be imported; paths are there; targets of make are the Makefile's."""
    page = _page("docs/development.md")
    named = re.findall(r"`((?:generated|generator|roverlink|runtime)[\w.]*):([\w.]+)`", page)
    assert len(named) > 20
    for module, name in named:
        found: object = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    paths = re.findall(r"`((?:generated|generator|roverlink|runtime|templates|tests|proto)/[\w./]*)`", page)
    assert [path for path in paths if not (ROOT / path).exists()] == []
    made = set(re.findall(r"^([a-z0-9-]+):", _page("Makefile"), re.MULTILINE))
    assert set(re.findall(r"make ([a-z0-9-]+)`", page)) <= made


_FOLDERS = [
    folder for product in (ROOT, ROOT / "rover", ROOT / "check_launch") for folder in (product, product / "docs")
]
_PAGES = [page for folder in _FOLDERS for page in sorted(folder.glob("*.md"))]


@pytest.mark.parametrize("page", _PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    """Links from page to page within the repository are not broken, as one reads it on GitHub."""
    prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", prose)
    assert [target for target in targets if not (page.parent / target).exists()] == []
