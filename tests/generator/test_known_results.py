"""What the last run has found is not worked out again, unless anything that it depends on has changed."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from roverlink.__main__ import main
from roverlink.generator import known_results, pipeline
from roverlink.generator.lint import project as lint_project

pytestmark = pytest.mark.slow


@pytest.fixture
def worked(project: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], tuple[list[int], int]]:
    """A function that calls `generate --check` and `lint`; the exit codes, and how many of them had work to do.

    Both commands know their results.
    """
    monkeypatch.setenv("XDG_CACHE_HOME", str(project.parent / "cache"))
    monkeypatch.chdir(project)
    done: list[str] = []
    for module, name in ((pipeline, "compile_table"), (lint_project, "lint_project")):
        call = getattr(module, name)

        def counted(*given: object, call: Callable[..., object] = call, **named: object) -> object:
            done.append("")
            return call(*given, **named)

        monkeypatch.setattr(module, name, counted)

    def run() -> tuple[list[int], int]:
        done.clear()
        return [main(["generate", "--check"]), main(["lint"])], len(done)

    assert [run() for _ in range(2)] == [([0, 0], 2), ([0, 0], 0)]
    return run


def _append(file: Path, text: str) -> None:
    file.write_text((file.read_text() if file.exists() else "") + text)


def _proto(project: Path) -> Path:
    return next(file for file in project.rglob("*.proto") if "generated" not in file.parts)


@pytest.mark.parametrize(
    ("change", "codes", "work"),
    [
        (lambda project: _append(project / "mapping.yaml", "# A comment.\n"), [0, 0], 2),
        (lambda project: _append(_proto(project), "// A comment.\n"), [0, 0], 2),
        (lambda project: _append(_proto(project).with_name("new.options"), "x"), None, 2),
        (lambda project: (project / "mapping.lock").unlink(), None, 2),
        (lambda project: _append(project / "generated" / "registry.py", "# Edited.\n"), [1, 0], 0),
        (lambda project: os.link(project / "generated" / "registry.py", project / "generated" / "old.py"), [1, 0], 0),
    ],
    ids=["table", "proto", "options", "no ledger", "edited output", "output left behind"],
)
def test_whatever_has_changed_is_noticed(
    project: Path,
    worked: Callable[[], tuple[list[int], int]],
    change: Callable[[Path], object],
    codes: list[int] | None,
    work: int,
) -> None:
    """An edited input is compiled again. Edited outputs are found without that."""
    change(project)
    found, done = worked()
    assert (codes is None or found == codes, done) == (True, work)


def test_a_cache_that_does_not_fit_is_no_cache(
    worked: Callable[[], tuple[list[int], int]], project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cut short, of another version, or asked for in a hook of git, which checks something else."""
    for file in (project.parent / "cache" / "roverlink").glob("*/*.json"):
        file.write_bytes(file.read_bytes()[:-1])
    assert (worked(), worked()) == (([0, 0], 2), ([0, 0], 0))
    with monkeypatch.context() as hook:
        hook.setenv("GIT_INDEX_FILE", "index")
        assert worked() == ([0, 0], 1)
    monkeypatch.setattr(known_results, "_version", lambda: b"another")
    assert worked() == ([0, 0], 2)
