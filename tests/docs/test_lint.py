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
    command = [*shlex.split(hook["entry"]), *hook.get("args", [])]
    done = subprocess.run(command, cwd=ROOT, env=_environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    pattern = re.compile(hook["files"])
    assert all(pattern.search(path) for path in ("proto/a/b.proto", "mapping.yaml", "mapping.lock"))
    assert not pattern.search("README.md")


def _git(folder: Path, *arguments: str) -> None:
    subprocess.run(["git", "-C", str(folder), *arguments], check=True, env=_environment(), capture_output=True)


_ANN = {"NAME": "Ann", "EMAIL": "ann@example.com"}


def _start(repository: Path, protos: Path) -> None:
    """A repository of protos without a table, whose past gave the number 12 to two payloads."""
    shutil.copytree(ROOT / "proto", protos)
    _git(repository, "init", "--initial-branch", "main")
    envelope = protos / "components" / "common" / "envelope.proto"
    text = envelope.read_text()
    gone = re.sub(r"^.* = 12;\n", "", text, flags=re.MULTILINE)
    for subject, content in (
        ("Add the protos", text),
        ("Drop the GPS", gone),
        (
            "Measure twice",
            gone.replace("oneof payload {\n", "oneof payload {\n    SensorBoardLoadCellInfo twice = 12;\n"),
        ),
    ):
        envelope.write_text(content)
        _git(repository, "add", "--all")
        _git(repository, "commit", "--message", subject)


_ROVER = """\
syntax = "proto3";
message Imu {{ float heading = 1; float pitch = 2;{roll} }}
{others}message Rover {{ oneof payload {{ Imu imu = 1; {member}}} }}
"""
_STATES = {
    "Begin": ("", "message Gps { double latitude = 1; double longitude = 2; }\n", "Gps gps = 2; "),
    "Remove the GPS": ("", "", ""),
    "Add the wind sensor": (" float roll = 3;", "message Wind { float speed = 1; }\n", "Wind wind = 2; "),
}


@pytest.mark.slow
def test_the_three_questions_have_the_answers_of_the_page(tmp_path: Path) -> None:
    """Each command of the section prints what the page shows, in a repository with the history that it tells of."""
    (tmp_path / "protos").mkdir()
    _git(tmp_path, "init", "--initial-branch", "main")
    for month, (subject, (roll, others, member)) in enumerate(_STATES.items(), 1):
        (tmp_path / "protos" / "rover.proto").write_text(_ROVER.format(roll=roll, others=others, member=member))
        _git(tmp_path, "add", "--all")
        date = f"2026-0{month}-02T12:00:00Z"
        people = {f"GIT_{who}_DATE": date for who in ("AUTHOR", "COMMITTER")}
        people |= {f"GIT_{who}_{what}": text for who in ("AUTHOR", "COMMITTER") for what, text in _ANN.items()}
        _run(f"git commit --quiet --message '{subject}' && git tag v{month}", tmp_path, people)
    (tmp_path / "boards.txt").write_text("rover v3\nbasestation v2\narm v1\n")
    section = _PAGE.read_text(encoding="utf-8").partition("## Three questions")[2].partition("\n## ")[0]
    shown = "".join(re.findall(r"^```console\n(.*?)^```", section, re.DOTALL | re.MULTILINE))
    commands = re.findall(r"^\$ (.*)", shown, re.MULTILINE)
    printed = ((command, _run(command, tmp_path, {})) for command in commands)
    assert _lines(shown) == _lines("".join(f"$ {command}\n{said.stdout}{said.stderr}" for command, said in printed))


def _lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.splitlines() if line.strip()]


@pytest.mark.slow
def test_the_hook_with_arguments_lints_a_repository_without_a_table(tmp_path: Path) -> None:
    """The second configuration passes where only the past is wrong, finds what a commit breaks, and is the third's."""
    shown = re.findall(r"^```yaml\n(repos:.*?)^```", _PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    (hook,) = yaml.safe_load(shown[1])["repos"][0]["hooks"]
    (known,) = (each for each in _hooks() if each["id"] == hook["id"])
    repository = tmp_path / "protos of a team"
    repository.mkdir()
    _start(repository, repository / "protos")
    command = shlex.join([*shlex.split(known["entry"]), *hook["args"]])
    assert "--history" in hook["args"]
    (local,) = yaml.safe_load(shown[2])["repos"][0]["hooks"]
    assert shlex.split(local["entry"]) == shlex.split(command)
    said = _run(command, repository, {})
    assert said.returncode == 0, said.stdout + said.stderr
    imu = repository / "protos" / "components" / "sensor_board" / "imu_sensor.proto"
    imu.write_text(imu.read_text().replace("float accel_x", "double accel_x"))
    said = _run(command, repository, {})
    assert said.returncode == 1
    assert "error[WIR101]" in said.stdout
    _git(tmp_path, "clone", "--depth", "1", f"file://{repository}", "shallow")
    said = _run(command, tmp_path / "shallow", {})
    assert said.returncode == 1
    assert "git fetch --unshallow" in said.stdout


@pytest.mark.slow
def test_the_workflow_to_copy_lints_a_pull_request(tmp_path: Path) -> None:
    """Its step, run in a clone of a repository of protos, finds what a branch breaks; the base branch's past passes."""
    workflow = yaml.safe_load((ROOT / "docs" / "workflows" / "lint-protos.yml").read_text(encoding="utf-8"))
    step = next(step for step in workflow["jobs"]["lint"]["steps"] if step.get("name") == "Lint")
    assert step["env"] == {"BASE": "origin/${{ github.base_ref }}"}
    origin, clone, home = tmp_path / "origin", tmp_path / "clone", tmp_path / "home"
    origin.mkdir()
    _start(origin, origin / "protos")
    _git(tmp_path, "clone", str(origin), str(clone))
    (home / "roverlink").mkdir(parents=True)
    (home / "roverlink" / "bin").symlink_to(Path(sys.executable).parent)
    env = {**workflow["env"], "PROTOS": "protos", "BASE": "origin/main", "HOME": str(home)}
    said = _run(step["run"], clone, env)
    assert said.returncode == 0, said.stdout + said.stderr
    assert all(line.startswith("::notice") for line in said.stdout.splitlines())
    envelope = clone / "protos" / "components" / "common" / "envelope.proto"
    text = envelope.read_text()
    for subject, content in (
        ("Drop the pressure", re.sub(r"^.* = 15;\n", "", text, flags=re.MULTILINE)),
        (
            "Weigh thrice",
            re.sub(r"^.* = 15;\n", "    SensorBoardLoadCellInfo thrice = 15;\n", text, flags=re.MULTILINE),
        ),
    ):
        envelope.write_text(content)
        _git(clone, "commit", "--all", "--message", subject)
    said = _run(step["run"], clone, env)
    assert said.returncode == 1
    assert "::error file=protos/components/common/envelope.proto,line=" in said.stdout
    assert "HIS101" in said.stdout


def test_a_workflow_without_a_source_of_roverlink_says_so(tmp_path: Path) -> None:
    """The empty ROVERLINK fails in the step that installs, before pip could be asked for anything."""
    workflow = yaml.safe_load((ROOT / "docs" / "workflows" / "lint-protos.yml").read_text(encoding="utf-8"))
    step = next(step for step in workflow["jobs"]["lint"]["steps"] if step.get("name") == "Install")
    said = _run(step["run"], tmp_path, {**workflow["env"], "HOME": str(tmp_path)})
    assert said.returncode != 0
    assert "ROVERLINK: is empty" in said.stderr
    assert list(tmp_path.iterdir()) == []


def _run(command: str, folder: Path, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """A step of a workflow, as the runner runs it."""
    return subprocess.run(
        ["bash", "-e", "-c", command], cwd=folder, env={**_environment(), **env}, capture_output=True, text=True
    )
