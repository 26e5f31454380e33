"""The generated package under a name of the project's own: its folder, its imports, and what it may be called."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from golden import ROOT, case, generate
from polling import PATIENCE_S
from trees import edit

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.table import reader

_LOADS = """
import sys
from pathlib import Path
from roverlink.generated_code import load_project
from roverlink.runtime import RegistryError, Translator
for folder in sys.argv[1:]:
    try:
        registry = load_project(Path(folder))
    except RegistryError as error:
        print(error)
        continue
    payload = registry.by_name["note"].payload_type(height=2.5)
    received = Translator(registry).receive(registry.envelope(note=payload).SerializeToString())
    print(type(registry.by_name["note"]).__module__, received[0])
"""


def _project(parent: Path, package: str) -> Path:
    """A generated project whose Python package has the name."""
    parent.mkdir()
    project = case("python_package").write_inputs(parent / "project")
    edit(project / "mapping.yaml", "my_rover.generated", package)
    assert generate(project).code == 0
    return project


@pytest.mark.slow
def test_packages_are_loaded_under_their_names(tmp_path: Path) -> None:
    """Two names work beside each other, and payloads cross; of two projects with one name, the second is refused."""
    first, second = _project(tmp_path / "a", "first.generated"), _project(tmp_path / "b", "second")
    third = _project(tmp_path / "c", "first.generated")
    done = subprocess.run(
        [sys.executable, "-c", _LOADS, first, second, third],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr
    *shown, refused = done.stdout.splitlines()
    assert shown == ["first.generated.handlers.note note", "second.handlers.note note"]
    assert f"of another project is loaded already: {first / 'first'}" in refused
    assert not (first / "generated").exists()


@pytest.mark.slow
def test_a_project_follows_its_package(tmp_path: Path) -> None:
    """What stands below the package's folder and is made no more goes, and an unchanged run writes nothing."""
    project = _project(tmp_path / "a", "my_rover.generated")
    assert generate(project, "--check").code == 0
    edit(project / "mapping.yaml", "templates: [own]\n", "")
    assert " removed my_rover/generated/own/numbers.h" in generate(project).stdout


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("roverlink.mine", "'roverlink' is a module of roverlink itself"),
        ("json", "'json' is a module of Python's standard library"),
        ("my_rover.import", "'import' is a Python keyword"),
        ("my-rover", "which is not a valid import name"),
        (".mine", "which is not a valid import name"),
        ("my_rover.2", "which is not a valid import name"),
    ],
)
def test_a_name_that_cannot_be_imported_is_refused(tmp_path: Path, name: str, expected: str) -> None:
    """Each is a finding at the name."""
    table = tmp_path / "mapping.yaml"
    text = case("python_package").inputs["mapping.yaml"].decode()
    table.write_text(text.replace("my_rover.generated", name), encoding="utf-8")
    findings: list[Diagnostic] = []

    assert reader.read(table, findings).python.package == "generated"
    assert [(finding.rule.id, finding.span.line, finding.span.column) for finding in findings] == [("MAP108", 6, 19)]
    assert expected in findings[0].message
