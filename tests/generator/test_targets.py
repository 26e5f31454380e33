"""Targets of other packages' and templates of users' own, from the command line to what is made of it."""

from __future__ import annotations

import importlib
import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from golden import PROBE_PROTO, PROBE_TABLE, generate, snapshot

from generated.registry import REGISTRY
from roverlink.runtime.core.translator import Translator

Install = Callable[[str], None]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project that wants no more than the Python code."""
    folder = tmp_path / "project"
    (folder / "proto").mkdir(parents=True)
    (folder / "mapping.yaml").write_text(f"{PROBE_TABLE}targets: [python]\n", encoding="utf-8")
    (folder / "proto" / "probe.proto").write_text(PROBE_PROTO, encoding="utf-8")
    return folder


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Installs a package that brings the target ``numbers``, whose `emit` has a body."""

    def install(body: str) -> None:
        site = tmp_path / "site-packages"
        about = site / "rover_numbers-1.0.dist-info"
        about.mkdir(parents=True)
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: rover-numbers\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[roverlink.targets]\nnumbers = rover_numbers:emit\n")
        (site / "rover_numbers.py").write_text(f"def emit(bridge):\n    {body}\n")
        monkeypatch.syspath_prepend(str(site))
        monkeypatch.delitem(sys.modules, "rover_numbers", raising=False)
        importlib.invalidate_caches()

    return install


def test_a_target_of_another_package_is_found_by_its_name(project: Path, install: Install) -> None:
    """An installed package's entry point makes files from the same bridge that ours see."""
    install('yield "generated/numbers.txt", "".join(f"{r.number} {r.name}\\n" for r in bridge.routes)')
    outcome = generate(project, "--target", "numbers")
    assert (outcome.code, outcome.stderr) == (0, "")
    assert (project / "generated" / "numbers.txt").read_text() == "1 probe\n"


def test_a_target_that_fails_is_named(project: Path, install: Install) -> None:
    """What goes wrong in another package's target is told with its name, and nothing is written."""
    install('raise KeyError("depth")')
    before = snapshot(project)
    outcome = generate(project, "--target", "numbers")
    assert outcome.code == 1
    failed = "error[OUT103] the target 'numbers' of the package 'rover-numbers' failed: KeyError: 'depth'"
    assert f"--target numbers: {failed}" in outcome.stderr
    assert snapshot(project) == before


@pytest.mark.parametrize("path", ["../outside.txt", "/outside.txt", "mapping.yaml", "generated", "generated/../a"])
def test_a_target_of_another_package_stays_in_the_folder(project: Path, install: Install, path: str) -> None:
    """No target of another package's writes anywhere but below generated/."""
    install(f'yield "{path}", "text"')
    before = snapshot(project)
    outcome = generate(project, "--target", "numbers")
    assert outcome.code == 1
    assert f"error[OUT104] cannot write '{path}': the path is not below generated/" in outcome.stderr
    assert snapshot(project) == before


def test_an_option_with_a_target_that_is_not_installed_is_a_mistake_of_the_command_line(project: Path) -> None:
    """A name that nobody brings gets the list of those that there are, and no place in the table."""
    outcome = generate(project, "--target", "fortran")
    assert (outcome.code, outcome.stderr[:58]) == (2, "roverlink: --target: unknown target 'fortran'; known: cpp,")


@pytest.mark.slow
def test_templates_of_a_folder_anywhere_are_used_end_to_end(project: Path, tmp_path: Path) -> None:
    """A template in a folder of the user's own becomes a module that other code can use to make a datagram."""
    own = tmp_path / "own" / "wire"
    own.mkdir(parents=True)
    (own / "numbers.py.j2").write_text(
        "{{ header(bridge.table) }}\nNUMBERS = {\n"
        '{% for route in bridge.routes %}\n    "{{ route.name }}": {{ route.number }},\n{% endfor %}\n}\n'
    )
    root = Path(__file__).parents[2]
    assert generate(root, "--template", str(own), "--check").code == 1  # which it would add
    outcome = generate(project, "--template", str(own))
    assert (outcome.code, outcome.stderr) == (0, "")
    numbers = runpy.run_path(str(project / "generated" / "wire" / "numbers.py"))["NUMBERS"]
    assert numbers == {"probe": 1}
    tag = bytes([numbers["probe"] << 3 | 2, 0])
    assert Translator(REGISTRY).receive(tag)[0] == REGISTRY.by_number[1].route.name
