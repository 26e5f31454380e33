"""A small generated project, for the tests of commands that write files."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from golden import case, generate


@pytest.fixture(scope="session")
def generated_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The case `nested`, generated; nobody changes it."""
    folder = case("nested").write_inputs(tmp_path_factory.mktemp("nested") / "project")
    assert generate(folder).code == 0
    return folder


@pytest.fixture
def project(generated_once: Path, tmp_path: Path) -> Path:
    """A small project, generated."""
    return Path(shutil.copytree(generated_once, tmp_path / "project"))
