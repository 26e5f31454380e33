"""docs/lint.md names hooks that run, and its workflow works."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from page import ROOT

_PAGE = ROOT / "docs" / "lint.md"


def _environment() -> dict[str, str]:
    """An environment in which `roverlink` is this one, and git knows who commits."""
    people = {f"GIT_{who}_{what}": "test@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    no_settings = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    return {**os.environ, **people, **no_settings, "PATH": path}


def _hooks() -> list[dict[str, Any]]:
    hooks: list[dict[str, Any]] = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    return hooks


@pytest.mark.parametrize("hook", _hooks(), ids=lambda hook: hook["id"])
@pytest.mark.slow
def test_the_hooks_run_and_are_named_on_the_page(hook: dict[str, Any]) -> None:
    """What pre-commit would call passes on this repository; its pattern takes the files that matter."""
    assert f"`{hook['id']}`" in _PAGE.read_text(encoding="utf-8")
    done = subprocess.run(shlex.split(hook["entry"]), cwd=ROOT, env=_environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    pattern = re.compile(hook["files"])
    assert all(pattern.search(path) for path in ("proto/a/b.proto", "mapping.yaml", "mapping.lock"))
    assert not pattern.search("README.md")


@pytest.mark.slow
def test_the_workflow_to_copy_lints_a_pull_request(tmp_path: Path) -> None:
    """Its step, run in a clone of a repository of protos, finds what a branch breaks against the base branch."""
    workflow = yaml.safe_load((ROOT / "docs" / "workflows" / "lint-protos.yml").read_text(encoding="utf-8"))
    step = next(step for step in workflow["jobs"]["lint"]["steps"] if step.get("name") == "Lint")
    origin, clone = tmp_path / "origin", tmp_path / "clone"
    shutil.copytree(ROOT / "proto", origin)

    def git(folder: Path, *arguments: str) -> None:
        subprocess.run(["git", "-C", str(folder), *arguments], check=True, env=_environment(), capture_output=True)

    git(origin, "init", "--initial-branch", "main")
    git(origin, "add", "--all")
    git(origin, "commit", "--message", "Add the protos")
    git(tmp_path, "clone", str(origin), str(clone))
    command = step["run"].replace("${{ github.base_ref }}", "main")
    said = _run(command, clone, workflow["env"])
    assert (said.returncode, said.stdout) == (0, "")
    imu = clone / "components" / "sensor_board" / "imu_sensor.proto"
    imu.write_text(imu.read_text().replace("float accel_x", "double accel_x"))
    said = _run(command, clone, workflow["env"])
    assert said.returncode == 1
    assert said.stdout.startswith("::error file=components/sensor_board/imu_sensor.proto,line=")


def _run(command: str, folder: Path, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """A step of a workflow, as the runner runs it."""
    return subprocess.run(
        ["bash", "-e", "-c", command], cwd=folder, env={**_environment(), **env}, capture_output=True, text=True
    )
