"""`buf breaking` as a function: what the reference finds between two folders of .proto files."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from roverlink.generator.lint.buf import executable

CATEGORIES = ("FILE", "WIRE_JSON", "WIRE")

_VIOLATIONS = 100  # the exit code of a check that found something
_ENVIRONMENT = {
    "BUF_CACHE_DIR": str(Path(tempfile.gettempdir()) / "roverlink-buf-cache"),  # it insists on one, and leaves it empty
    "GOMAXPROCS": "1",  # of many short runs at a time, each is best off with one thread
    "GOGC": "off",
}


@dataclass(frozen=True, order=True)
class BufFinding:
    """A violation; lines and columns count from 1, and what has no place is at 1:1, without a path if it has none."""

    path: str
    line: int
    column: int
    rule: str
    message: str


class BufError(Exception):
    """What buf says of states that it cannot compare, such as files that do not compile or no files at all."""


needs_buf = pytest.mark.skipif(executable() is None, reason="need buf (pip install buf-bin)")


def breaking(before: Path, after: Path, categories: Sequence[str] = CATEGORIES) -> list[BufFinding]:
    """What buf reports of the second folder against the first, in order; paths are relative to the folder."""
    config = json.dumps({"version": "v2", "breaking": {"use": list(categories)}})
    command = [".", "--against", str(before.resolve()), "--config", config, "--against-config", '{"version": "v2"}']
    said = _run(after, "breaking", *command, "--error-format", "json")
    findings = sorted(_finding(json.loads(line)) for line in said.splitlines())
    if any(finding.rule == "COMPILE" for finding in findings):
        raise BufError(said)
    return findings


@cache
def categories_of_rules() -> dict[str, frozenset[str]]:
    """The rules that are not deprecated, each with those of our categories that it is in."""
    lines = _run(Path.cwd(), "config", "ls-breaking-rules", "--version", "v2", "--format", "json").splitlines()
    return {rule["id"]: frozenset(rule["categories"]) & frozenset(CATEGORIES) for rule in map(json.loads, lines)}


def _run(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [executable() or "buf", *arguments],
        cwd=folder,
        env={**os.environ, **_ENVIRONMENT},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    if done.returncode not in (0, _VIOLATIONS):
        raise BufError(done.stderr or done.stdout)
    return done.stdout


def _finding(said: dict[str, object]) -> BufFinding:
    line, column = (int(str(said.get(key, 0))) for key in ("start_line", "start_column"))
    return BufFinding(str(said.get("path", "")), line, column, str(said["type"]), str(said["message"]))
