"""A command that is killed while it writes files: the next command finds the old tree or the new one, and no more."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from golden import Outcome, generate, inside, snapshot
from trees import edit

from roverlink.__main__ import main

_UNFINISHED = ".roverlink-unfinished"
Hook = Callable[[str], None]


@pytest.fixture
def project(project: Path) -> Path:
    """A generated project whose table has changed since, so that files have to be added, changed and removed."""
    edit(project / "mapping.yaml", "name: wrist", "name: hand")
    edit(project / "mapping.yaml", "package: rover", "package: robot")
    return project


@pytest.fixture
def finished(project: Path, tmp_path: Path) -> dict[str, bytes]:
    """The content of the project after a run that nobody kills."""
    copy = shutil.copytree(project, tmp_path / "finished")
    assert generate(copy).code == 0
    return snapshot(copy)


def _roverlink(project: Path, *arguments: str) -> Outcome:
    """`roverlink` in a project's folder, in this process."""
    stdout, stderr = io.StringIO(), io.StringIO()
    with inside(project), contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
        code = main(arguments)
    return Outcome(code, stdout.getvalue(), stderr.getvalue())


def _started(project: Path, arguments: tuple[str, ...], hook: Hook) -> int:
    """Start a command in a process that calls ``hook`` with the name of each audit event; return the process id.

    The process is forked, because importing the generator anew for each kill would take most of the time.
    """
    pid = os.fork()
    if pid == 0:
        sys.addaudithook(lambda event, _: hook(event))
        with contextlib.suppress(BaseException):
            _roverlink(project, *arguments)
        os._exit(0)
    return pid


def _killed_before(project: Path, event: str, count: int, *arguments: str) -> None:
    """Run a command that is killed just before it causes an event for the ``count``-th time."""
    seen = 0

    def hook(name: str) -> None:
        nonlocal seen
        seen += name == event
        if name == event and seen == count:
            os.kill(os.getpid(), signal.SIGKILL)

    _, status = os.waitpid(_started(project, arguments, hook), 0)
    assert os.WIFSIGNALED(status)


_NEXT = [("generate", "--check"), ("lint",), ("explain", "arm")]


@pytest.mark.slow
@pytest.mark.parametrize("command", [*_NEXT, ("send", "arm")])
def test_the_next_command_rolls_back_what_was_only_prepared(project: Path, command: tuple[str, ...]) -> None:
    """Killed before its journal is complete, generate has changed nothing; the next command removes its leftovers."""
    before = snapshot(project)
    _killed_before(project, "os.rename", 1, "generate")
    assert (project / _UNFINISHED).is_dir()
    outcome = _roverlink(project, *command)
    assert "rolled back what an interrupted command had begun to write" in outcome.stderr
    assert snapshot(project) == before


@pytest.mark.parametrize("renamed", [2, *(pytest.param(count, marks=pytest.mark.slow) for count in (3, 10))])
@pytest.mark.parametrize("command", _NEXT)
def test_the_next_command_completes_the_switch(
    project: Path, finished: dict[str, bytes], renamed: int, command: tuple[str, ...]
) -> None:
    """Killed while it replaces files, generate leaves a journal, with which the next command does the rest."""
    _killed_before(project, "os.rename", renamed, "generate")
    outcome = _roverlink(project, *command)
    assert "completed what an interrupted command had begun to write" in outcome.stderr
    assert outcome.code == 0
    assert snapshot(project) == finished


@pytest.mark.slow
def test_a_project_that_was_never_finished_is_found(tmp_path: Path) -> None:
    """After a killed `init`, there may be no mapping.yaml yet; the next command starts with the journal."""
    _killed_before(tmp_path, "os.rename", 2, "init")
    assert not (tmp_path / "mapping.yaml").exists()
    assert _roverlink(tmp_path, "generate", "--check").code == 0
    assert (tmp_path / "mapping.yaml").exists()


@pytest.mark.slow
def test_what_was_edited_since_is_left_as_it_is(project: Path, finished: dict[str, bytes]) -> None:
    """A file that somebody edits between the kill and the next command keeps the edit, and is named."""
    _killed_before(project, "os.rename", 2, "generate")
    edited = project / "generated" / "registry.py"
    edited.write_text("# edited by hand\n")
    outcome = _roverlink(project, "generate", "--check")
    assert "'generated/registry.py' was changed since then and is left as it is" in outcome.stderr
    assert outcome.code == 1
    assert snapshot(project) == {**finished, "generated/registry.py": b"# edited by hand\n"}


@pytest.mark.slow
def test_a_switch_that_cannot_be_completed_is_rolled_back(project: Path) -> None:
    """If a file cannot be replaced after a kill, the files that were replaced before get their old content back."""
    before = snapshot(project)
    _killed_before(project, "os.rename", 6, "generate")
    waiting = sorted((project / _UNFINISHED).glob("new-*"))
    waiting[-1].write_text("damaged")
    outcome = _roverlink(project, "generate", "--check")
    assert "rolled back what an interrupted command had begun to write" in outcome.stderr
    assert snapshot(project) == before


_EVIL = b"evil\n"
_STEP = [None, hashlib.sha256(_EVIL).hexdigest()]
_STOLEN = ["../stolen", "{outside}/stolen", ".git/hooks/pre-commit", "link/stolen", ""]
_NO_JOURNALS = ["", "[]", "{}", '{"steps": [[1, 2, 3]], "folders": []}', '{"steps": 7, "folders": []}', "[" * 100_000]
_LEFT = "move it to another place"


@pytest.mark.parametrize(
    ("files", "said"),
    [
        *(({"complete.json": json.dumps({"steps": [[path, *_STEP]], "folders": [".."]})}, "") for path in _STOLEN),
        *(({"complete.json": content}, _LEFT) for content in _NO_JOURNALS),
        ({"thesis.txt": "important"}, "it contains 'thesis.txt'"),
    ],
    ids=[*_STOLEN, *(f"no journal: {content[:10]}" for content in _NO_JOURNALS), "a folder of the user"],
)
def test_what_is_not_our_journal_changes_nothing(project: Path, files: dict[str, str], said: str) -> None:
    """A journal of a stranger that names files elsewhere or git's hooks, and other files in its place, are refused.

    The exit code is 2, the message says what to do, and files have their content; a journal may get another name.
    """
    (project / ".git" / "hooks").mkdir(parents=True)
    (project / "link").symlink_to(project.parent)
    folder = project / _UNFINISHED
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text.replace("{outside}", str(project.parent)))
    (folder / "new-0").write_bytes(_EVIL)
    before = snapshot(project.parent)
    outcome = generate(project)
    assert outcome.code == 2
    assert said in outcome.stderr
    assert "Traceback" not in outcome.stderr
    after = snapshot(project.parent)
    assert {path.replace("roll-back.json", "complete.json"): data for path, data in after.items()} == before
