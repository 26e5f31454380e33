"""docs/lint.md names hooks that run; the action and the workflows do what they say."""

from __future__ import annotations

import json
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

from roverlink.generator.new_project import files_about_repository

_PAGE = ROOT / "docs" / "lint.md"


_HOOKS: list[dict[str, Any]] = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
_ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
_WORKFLOWS = sorted((ROOT / "docs" / "workflows").glob("*.yml"))


def _run(command: str, folder: Path, env: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """Run a step of a workflow as the runner does; `roverlink` is this one, and git knows who commits."""
    people = {f"GIT_{who}_{what}": "test@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    no_settings = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    environment = {**os.environ, **people, **no_settings, "PATH": path, **(env or {})}
    command = ["bash", "-e", "-c", command]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


def _step(name: str) -> Any:
    """A step of the action."""
    return next(step for step in _ACTION["runs"]["steps"] if step.get("name") == name)


@pytest.mark.parametrize("hook", _HOOKS, ids=lambda hook: hook["id"])
@pytest.mark.slow
def test_the_hooks_run_and_are_named_on_the_page(hook: dict[str, Any]) -> None:
    """What pre-commit would call passes on this repository; its pattern takes the files that matter."""
    assert f"`{hook['id']}`" in _PAGE.read_text(encoding="utf-8")
    done = _run(shlex.join([*shlex.split(hook["entry"]), *hook.get("args", [])]), ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    pattern = re.compile(hook["files"])
    assert all(pattern.search(path) for path in ("proto/a/b.proto", "mapping.yaml", "mapping.lock"))
    assert not pattern.search("README.md")


def _commit(repository: Path, subject: str, env: dict[str, str] | None = None) -> None:
    done = _run(f"git add --all && git commit --quiet --message '{subject}'", repository, env)
    assert done.returncode == 0, done.stderr


_ANN = {"NAME": "Ann", "EMAIL": "ann@example.com"}


def _start(repository: Path) -> None:
    """A repository of protos without a table, whose past gave the number 12 to two payloads."""
    shutil.copytree(ROOT / "proto", repository / "protos")
    _run("git init --initial-branch main", repository)
    envelope = repository / "protos" / "components" / "common" / "envelope.proto"
    text = envelope.read_text()
    gone = re.sub(r"^.* = 12;\n", "", text, flags=re.MULTILINE)
    twice = gone.replace("oneof payload {\n", "oneof payload {\n    SensorBoardLoadCellInfo twice = 12;\n")
    for subject, content in (("Add the protos", text), ("Drop the GPS", gone), ("Measure twice", twice)):
        envelope.write_text(content)
        _commit(repository, subject)


@pytest.mark.slow
def test_a_taken_number_is_reported_as_the_pages_show_it(tmp_path: Path) -> None:
    """The place, the commit and the help are those of a row at the end of the table of this repository."""
    shutil.copytree(ROOT / "proto", tmp_path / "proto")
    shutil.copy(ROOT / "mapping.lock", tmp_path)
    text, table = (ROOT / "mapping.yaml").read_text(encoding="utf-8"), tmp_path / "mapping.yaml"
    table.write_text(text, encoding="utf-8")
    _run("git init --initial-branch main", tmp_path)
    _commit(tmp_path, "Add the IMU", {f"GIT_{who}_DATE": "2026-03-02T12:00:00Z" for who in ("AUTHOR", "COMMITTER")})
    row = "  - number: 13\n    name: two\n    proto: SensorBoardIMUInfo\n    topic: b\n    direction: hardware_to_ros\n"
    table.write_text(text.replace("\n\nretired:", f"\n{row}\nretired:"), encoding="utf-8")
    said = re.sub(r"\([0-9a-f]{10} ", "(commit ", _run("roverlink lint", tmp_path).stdout)
    for page in (_PAGE, ROOT / "README.md"):
        shown = re.findall(r"^```text\n(.*?ENV101.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
        assert re.sub(r"\([0-9a-f]{10} ", "(commit ", shown[0]) in said


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
    _run("git init --initial-branch main", tmp_path)
    for month, (subject, (roll, others, member)) in enumerate(_STATES.items(), 1):
        (tmp_path / "protos" / "rover.proto").write_text(_ROVER.format(roll=roll, others=others, member=member))
        people = {f"GIT_{who}_DATE": f"2026-0{month}-02T12:00:00Z" for who in ("AUTHOR", "COMMITTER")}
        people |= {f"GIT_{who}_{what}": text for who in ("AUTHOR", "COMMITTER") for what, text in _ANN.items()}
        _commit(tmp_path, subject, people)
        _run(f"git tag v{month}", tmp_path)
    (tmp_path / "boards.txt").write_text("rover v3\nbasestation v2\narm v1\n")
    section = _PAGE.read_text(encoding="utf-8").partition("## Three questions")[2].partition("\n## ")[0]
    shown = "".join(re.findall(r"^```console\n(.*?)^```", section, re.DOTALL | re.MULTILINE))
    commands = re.findall(r"^\$ (.*)", shown, re.MULTILINE)
    printed = ((command, _run(command, tmp_path)) for command in commands)
    assert _lines(shown) == _lines("".join(f"$ {command}\n{said.stdout}{said.stderr}" for command, said in printed))


def _lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.splitlines() if line.strip()]


@pytest.mark.slow
def test_the_hook_with_arguments_lints_a_repository_without_a_table(tmp_path: Path) -> None:
    """The second configuration passes where only the past is wrong, finds what a commit breaks, and is the third's."""
    shown = re.findall(r"^```yaml\n(repos:.*?)^```", _PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    (hook,) = yaml.safe_load(shown[1])["repos"][0]["hooks"]
    (known,) = (each for each in _HOOKS if each["id"] == hook["id"])
    repository = tmp_path / "protos of a team"
    repository.mkdir()
    _start(repository)
    command = shlex.join([*shlex.split(known["entry"]), *hook["args"]])
    assert "--history" in hook["args"]
    (local,) = yaml.safe_load(shown[2])["repos"][0]["hooks"]
    assert shlex.split(local["entry"]) == shlex.split(command)
    said = _run(command, repository)
    assert said.returncode == 0, said.stdout + said.stderr
    imu = repository / "protos" / "components" / "sensor_board" / "imu_sensor.proto"
    imu.write_text(imu.read_text().replace("float accel_x", "double accel_x"))
    said = _run(command, repository)
    assert said.returncode == 1
    assert "error[WIR101]" in said.stdout
    _run(f"git clone --depth 1 'file://{repository}' shallow", tmp_path)
    said = _run(command, tmp_path / "shallow")
    assert said.returncode == 1
    assert "git fetch --unshallow" in said.stdout


_BASES: dict[str, tuple[dict[str, object], str]] = {
    "a pull request": ({"github.base_ref": "dev"}, "origin/dev"),
    "a push": ({"github.event.before": "4c1f09ab27"}, "4c1f09ab27"),
    "the first push of a branch": ({"github.event.created": True, "github.event.before": "0" * 40}, "origin/main"),
    "started by hand": ({}, "origin/main"),
}


@pytest.mark.parametrize("event", _BASES)
def test_each_event_has_its_base(event: str, tmp_path: Path) -> None:
    """A push is not compared with itself: in the action, and in the workflow that `init` writes."""
    text = files_about_repository(tmp_path, "").texts[".github/workflows/roverlink.yml"]
    steps = [_step("Lint"), yaml.safe_load(text)["jobs"]["lint"]["steps"][-1]]
    facts, base = _BASES[event]
    known = {"github.event.repository.default_branch": "main", **facts}
    for step in steps:
        expression = step["env"]["BASE"].removeprefix("${{").removesuffix("}}").replace("!", " not ")
        expression = expression.replace("&&", "and").replace("||", "or").replace("format(", "str.format(").strip()
        value = re.sub(r"(?:github|inputs)[.][\w.]+", lambda name: repr(known.get(name[0])), expression)
        assert eval(value) == base  # noqa: S307  # an expression of our own workflow, whose operators Python has


@pytest.mark.slow
def test_the_step_of_the_action_lints_a_push(tmp_path: Path) -> None:
    """Run in a clone, it finds what a push breaks; the past passes; the commit before a forced push is fetched."""
    origin, clone, runner = tmp_path / "origin", tmp_path / "clone", tmp_path / "runner"
    origin.mkdir()
    _start(origin)
    _run("git checkout -b gone && git commit --allow-empty --message Gone && git checkout main", origin)
    gone = _run("git rev-parse gone", origin).stdout.strip()
    _run(f"git clone --branch main --single-branch 'file://{origin}' {clone}", tmp_path)
    _run("git branch -D gone && git config uploadpack.allowAnySHA1InWant true", origin)  # as GitHub has it
    (runner / "roverlink").mkdir(parents=True)
    (runner / "roverlink" / "bin").symlink_to(Path(sys.executable).parent)
    env = {"PROTOS": "protos", "MESSAGE": "PBEnvelope", "SARIF": "", "RUNNER_TEMP": str(runner)}
    for base, warned in (("origin/main", False), (gone, False), ("1" * 40, True)):
        said = _run(_step("Lint")["run"], clone, {**env, "BASE": base})
        assert said.returncode == 0, said.stdout + said.stderr
        assert ("::warning::the commit before this push" in said.stdout) == warned
        assert "::error" not in said.stdout
    envelope = clone / "protos" / "components" / "common" / "envelope.proto"
    text = envelope.read_text()
    for subject, line in (("Drop the pressure", ""), ("Weigh thrice", "    SensorBoardLoadCellInfo thrice = 15;\n")):
        envelope.write_text(re.sub(r"^.* = 15;\n", line, text, flags=re.MULTILINE))
        _commit(clone, subject)
    said = _run(_step("Lint")["run"], clone, {**env, "BASE": "origin/main"})
    assert said.returncode == 1
    assert "::error file=protos/components/common/envelope.proto,line=" in said.stdout
    assert "HIS101" in said.stdout
    said = _run(_step("Lint")["run"], clone, {**env, "BASE": "origin/main", "SARIF": "roverlink.sarif"})
    assert (said.returncode, said.stdout) == (1, "")
    assert json.loads((clone / "roverlink.sarif").read_text())["runs"][0]["results"]


@pytest.mark.slow
def test_actions_and_workflows_are_what_github_reads(tmp_path: Path) -> None:
    """GitHub's own schemas accept the action, the workflows to copy, and those that `init` writes."""
    pytest.importorskip("check_jsonschema", reason="need check-jsonschema (pip install '.[full]')")
    git = {"GIT_CONFIG_GLOBAL": os.devnull}
    (tmp_path / "sub folder").mkdir()
    (tmp_path / ".gitmodules").touch()
    _run("git init --initial-branch dev && git commit --allow-empty --message Begin", tmp_path, git)
    texts = files_about_repository(tmp_path / "sub folder", "git+https://example.com/r@1").texts
    written = tmp_path / "workflow.yml"
    written.write_text(texts[".github/workflows/roverlink.yml"])
    workflow = yaml.safe_load(written.read_text())
    assert workflow[True]["push"]["branches"] == ["dev"]  # YAML 1.1 reads `on` as true
    job = workflow["jobs"]["lint"]
    assert job["defaults"]["run"]["working-directory"] == "sub folder"
    assert job["steps"][0]["with"] == {"fetch-depth": 0, "submodules": "recursive"}
    (hook,) = yaml.safe_load(texts[".pre-commit-config.yaml"])["repos"][0]["hooks"]
    assert shlex.split(hook["entry"])[-2:] == ["--table", "sub folder/mapping.yaml"]
    assert hook["always_run"] is True
    for schema, files in (("actions", [ROOT / "action.yml"]), ("workflows", [*_WORKFLOWS, written])):
        done = subprocess.run(
            [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.github-{schema}", *files],
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout
