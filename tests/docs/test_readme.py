"""README.md is true: its walk-through works, its code runs, and its tables are complete."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest
import reference
from needs import NO_DDS
from page import ROOT, Reader, blocks

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime.ros_arguments import parameters

_README = ROOT / "README.md"


def _table(heading: str) -> dict[str, str]:
    """The first two columns of the table below a heading line."""
    _, _, below = _README.read_text(encoding="utf-8").partition(f"\n{heading}\n")
    table = below.partition("\n\n")[0]
    return dict(re.findall(r"^\| `([^`]*)` \| ([^|]*?) \|", table, re.MULTILINE))


def test_the_walk_through_works(tmp_path: Path) -> None:
    """A reader adds the 22nd message, and it crosses."""
    pytest.importorskip("cyclonedds", reason=NO_DDS)
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_README, "One row, one message"))


def test_the_code_runs() -> None:
    """What stands under "From code" shows what it says."""
    (code,) = (block.text for block in blocks(_README, "From code") if block.language == "pycon")
    test = doctest.DocTestParser().get_doctest(code, {}, "README.md", str(_README), 0)
    runner = doctest.DocTestRunner()

    runner.run(test)

    assert (runner.failures, runner.tries) == (0, len(test.examples))


def test_the_parameters_are_those_of_the_node() -> None:
    """Every parameter of `roverlink run` stands there with its default."""
    defaults = {name: str(value) for name, value in parameters.defaults(REGISTRY).items()}

    assert _table("| parameter | default | |") == defaults
    page = _README.read_text(encoding="utf-8")
    assert page == reference.current(page), "run: make docs-reference"


def test_every_command_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    """The table of commands has those that `roverlink --help` lists, and no other; a group has a row for each."""
    with pytest.raises(SystemExit):
        main(["--help"])
    commands = re.findall(r"^    ([\w-]+)(?: |$)", capsys.readouterr().out, re.MULTILINE)

    assert list(dict.fromkeys(row.split()[1] for row in _table("| command | what it does |"))) == commands


@pytest.mark.parametrize("page", [_README, *sorted((ROOT / "docs").glob("*.md"))], ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """Links from page to page within the project are not broken."""
    prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    targets = re.findall(r"\]\(([^)#:]+)\)", prose)

    assert [target for target in targets if not (page.parent / target).exists()] == []
