"""README.md is true: its walk-through works, its code runs, and its tables are complete."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest
from needs import NO_DDS
from page import ROOT, Reader, blocks

from roverlink.command_line import COMMANDS

_README = ROOT / "README.md"


def _table(heading: str) -> dict[str, str]:
    """The first two columns of the table below a heading line."""
    _, _, below = _README.read_text(encoding="utf-8").partition(f"\n{heading}\n")
    table = below.partition("\n\n")[0]
    return dict(re.findall(r"^\| `([^`]*)` \| ([^|]*?) \|", table, re.MULTILINE))


@pytest.mark.slow
def test_the_walk_through_works(tmp_path: Path) -> None:
    """A reader adds the 22nd message, and it crosses."""
    pytest.importorskip("cyclonedds", reason=NO_DDS)
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_README, "Add a message"))


def test_the_code_runs() -> None:
    """The Python session prints what the README shows."""
    (code,) = (
        block.text for block in blocks(_README, "Use the handlers in your own node") if block.language == "pycon"
    )
    test = doctest.DocTestParser().get_doctest(code, {}, "README.md", str(_README), 0)
    runner = doctest.DocTestRunner()

    runner.run(test)

    assert (runner.failures, runner.tries) == (0, len(test.examples))


def test_every_command_is_listed() -> None:
    """The table of commands has the commands of `roverlink --help`, in that order."""
    assert [row.split()[1] for row in _table("| command | what it does |")] == list(COMMANDS)


@pytest.mark.parametrize("page", [_README, *sorted((ROOT / "docs").glob("*.md"))], ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """Links from page to page within the project are not broken."""
    prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    targets = re.findall(r"\]\(([^)#:]+)\)", prose)

    assert [target for target in targets if not (page.parent / target).exists()] == []
