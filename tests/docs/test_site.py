"""The documentation site builds, is complete, and needs no other host."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from page import ROOT

from roverlink import runtime
from roverlink.command_line import COMMANDS
from roverlink.commands.explain import all_rules
from roverlink.generator.ir import interfaces, model
from roverlink.runtime import client


def _build(project: Path, site: Path) -> subprocess.CompletedProcess[str]:
    """Run what `make docs` runs."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(site)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    return subprocess.run(command, cwd=project, env=environment, capture_output=True, text=True)


pytestmark = pytest.mark.slow  # they build the site


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The site of this project: the text of each page, by its path."""
    folder = tmp_path_factory.mktemp("site")
    done = _build(ROOT, folder)
    assert done.returncode == 0, done.stderr
    return {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in folder.rglob("*.html")}


def test_every_rule_command_and_class_is_there(pages: dict[str, str]) -> None:
    """A link to `reference/rules/ENV.html#env101` leads to the rule; commands show options, the bridge its classes."""
    known = all_rules()
    assert [id for id in known if f'id="{id.lower()}"' not in pages[f"reference/rules/{id[:3]}.html"]] == []
    commands = {Path(path).stem for path in pages if path.startswith("reference/commands/")}
    assert commands == {*COMMANDS, "index"}
    assert "--against" in pages["reference/commands/lint.html"]
    assert "--landmarks" in pages["reference/commands/aruco.html"]  # of a subcommand
    classes = [
        one.__name__
        for module in (model, interfaces)
        for one in vars(module).values()
        if isinstance(one, type) and one.__module__ == module.__name__
    ]
    assert [name for name in classes if f'id="{name.lower()}"' not in pages["reference/bridge.html"]] == []
    for module, page in ((runtime, "runtime"), (client, "client")):
        shown = pages[f"reference/{page}.html"]
        assert [name for name in module.__all__ if f'id="{name.lower()}"' not in shown] == []


def test_pages_of_all_products_are_there_and_lead_to_each_other(pages: dict[str, str]) -> None:
    """A link is a path in the repository; on the site, it leads to the page on the site."""
    assert 'href="../docs' not in pages["rover/index.html"]
    assert 'href="../install.html#extras"' in pages["rover/index.html"]
    assert 'href="vision.html"' in pages["rover/index.html"]
    assert 'href="rover/index.html"' in pages["index.html"]
    assert 'href="../check_launch/check-launch.html"' in pages["rover/navigation.html"]


def test_the_site_loads_nothing_from_other_hosts(pages: dict[str, str]) -> None:
    """Scripts, styles and pictures come with the site; only links that a reader follows lead elsewhere."""
    loaded = re.compile(
        r"<(?:script|img|source|iframe)[^>]*src=\"?https?:|<link[^>]*(?:stylesheet|preconnect)[^>]*https?:"
    )
    assert [path for path, text in pages.items() if loaded.search(text)] == []
    assert [path for path, text in pages.items() if 'class="mermaid"' in text] == []  # its script comes from elsewhere
    assert 'src="messages-1.svg"' in pages["messages.html"]
