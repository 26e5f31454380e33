"""The documentation site builds, is complete, and needs no other host."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from page import ROOT

from roverlink.command_line import COMMANDS
from roverlink.generator.ir import interfaces, model
from roverlink.generator.rule_catalogue import rules
from roverlink.launch_check.rules.launch_rules import launch_rules


def _build(project: Path, site: Path) -> subprocess.CompletedProcess[str]:
    """Run what `make docs` runs."""
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(site)],
        cwd=project,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
    )


pytestmark = pytest.mark.slow  # they build the site


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site of this project."""
    folder = tmp_path_factory.mktemp("site")
    done = _build(ROOT, folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_rule_has_a_section(site: Path) -> None:
    """A link to `reference/rules/ENV.html#env101` leads to the rule."""
    pages = {path.stem: path.read_text(encoding="utf-8") for path in (site / "reference" / "rules").glob("*.html")}

    assert [id for id in {**rules(), **launch_rules()} if f'id="{id.lower()}"' not in pages[id[:3]]] == []


def test_every_command_has_a_page_with_its_options(site: Path) -> None:
    """The pages come from the parser: each command is there, and so is an option of a subcommand."""
    pages = {path.stem: path.read_text(encoding="utf-8") for path in (site / "reference" / "commands").glob("*.html")}

    assert pages.keys() == {*COMMANDS, "index"}
    assert "--against" in pages["lint"]
    assert "--landmarks" in pages["aruco"]


def test_every_class_that_a_template_sees_is_listed(site: Path) -> None:
    """The page on the bridge has a section for each class of the IR."""
    page = (site / "reference" / "bridge.html").read_text(encoding="utf-8")
    classes = [
        cls
        for module in (model, interfaces)
        for cls in vars(module).values()
        if isinstance(cls, type)
        if cls.__module__ == module.__name__
    ]

    assert [cls.__name__ for cls in classes if f'id="{cls.__name__.lower()}"' not in page] == []


def test_the_site_loads_nothing_from_other_hosts(site: Path) -> None:
    """Scripts, styles and pictures come with the site; only links that a reader follows lead elsewhere."""
    loaded = re.compile(
        r"<(?:script|img|source|iframe)[^>]*src=\"?https?:|<link[^>]*(?:stylesheet|preconnect)[^>]*https?:"
    )
    pages = {path.name: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}

    assert [name for name, text in pages.items() if loaded.search(text)] == []
    assert [name for name, text in pages.items() if 'class="mermaid"' in text] == []  # its script comes from elsewhere


def _copy_with_page(folder: Path, text: str) -> Path:
    """Copy what the site is made of, with a short page."""
    for name in ("mkdocs.yml", "README.md", "CHANGELOG.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    shutil.copytree(ROOT / "docs", folder / "docs")
    page = folder / "docs" / "messages.md"
    page.write_text(f"# Messages\n\n{text}\n", encoding="utf-8")
    return folder


def test_dead_links_fail_the_build(tmp_path: Path) -> None:
    """A link to a missing page and a link to a missing section are errors that name the links."""
    project = _copy_with_page(tmp_path, "[a](nowhere.md) [b](lint.md#nowhere)")

    done = _build(project, tmp_path / "site")

    assert done.returncode == 1
    assert "nowhere.md" in done.stderr
    assert "lint.md#nowhere" in done.stderr


def test_a_diagram_is_drawn_when_the_site_is_built(tmp_path: Path) -> None:
    """A Mermaid block becomes a picture, so a reader needs no script from another host."""
    project = _copy_with_page(tmp_path, "```mermaid\nflowchart LR\n  board --> rover\n```")

    done = _build(project, tmp_path / "site")

    assert done.returncode == 0, done.stderr
    assert "board" in (tmp_path / "site" / "messages-1.svg").read_text(encoding="utf-8")
    assert 'src="messages-1.svg"' in (tmp_path / "site" / "messages.html").read_text(encoding="utf-8")
