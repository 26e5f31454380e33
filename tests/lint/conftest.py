"""What the tests of the lint share."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from repositories import RepositoryBuilder

from roverlink.__main__ import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """A command in this process: exit code, standard output, standard error."""

    def call(*arguments: str | Path) -> tuple[int, str, str]:
        code = main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


@pytest.fixture
def found(run: Run) -> Callable[..., tuple[int, list[dict[str, Any]]]]:
    """The lint in this process: exit code, and findings."""

    def call(*arguments: str | Path) -> tuple[int, list[dict[str, Any]]]:
        code, out, err = run("lint", *arguments, "--format", "json")
        assert err == ""
        return code, json.loads(out)

    return call


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository without commits."""
    return RepositoryBuilder(tmp_path / "repository")
