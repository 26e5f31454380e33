"""The generated Python reads as if written by hand: it compiles, and the formatter and the linter leave it as it is."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
import yaml
from case_file import CaseFile
from golden import ROOT, files_of, passing_cases
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.generator.ir import ros_names
from roverlink.generator.pipeline import compile_table

_NAMES = st.from_regex(r"[a-z]{1,75}", fullmatch=True).filter(lambda name: not ros_names.unusable(name))
_TEXTS = st.text(st.sampled_from("ab.  \"'\\#({\t\n\f\u00e4\u5bbd"), max_size=120)
_ROWS = st.tuples(_NAMES, _TEXTS, _TEXTS, st.binary(max_size=80))
_CASES = pytest.mark.parametrize("case", passing_cases(), ids=lambda case: case.name)
_UNTYPED = ("extensions",)
"""What protoc's stubs say of a message with extensions is in no release of protobuf's own stubs."""


def _python(case: CaseFile) -> dict[str, str]:
    """The generated modules that are ours, not protoc's."""
    return {path: text for path, text in files_of(case).items() if _is_ours(path)}


def _is_ours(path: str) -> bool:
    return path.endswith(".py") and "/pb2/" not in path


def _formatted(modules: dict[str, str]) -> dict[str, str]:
    """The modules as black lays them out in 88 columns."""
    import black  # here: to import it is a twentieth of the collection

    mode = black.Mode(line_length=88, target_versions={black.TargetVersion.PY310})
    return {path: black.format_str(text, mode=mode) for path, text in modules.items()}


def _folder(case: CaseFile) -> str:
    """The folder of the generated package."""
    return next(path.removesuffix("/registry.py") for path in files_of(case) if path.endswith("/registry.py"))


@pytest.mark.slow
@_CASES
def test_black_leaves_it_as_it_is(case: CaseFile) -> None:
    """Every module is laid out as black lays it out in 88 columns."""
    assert _python(case) == _formatted(_python(case))


@pytest.mark.slow
@settings(max_examples=8)
@given(package=_NAMES, rows=st.lists(_ROWS, min_size=8, max_size=8, unique_by=lambda row: row[0].title()))
def test_black_leaves_any_text_and_any_length_as_it_is(package: str, rows: list[tuple[str, str, str, bytes]]) -> None:
    """The same is true for comments and values with any characters, and for names of any length."""
    table = {
        "version": 1,
        "proto": {"root": "."},
        "envelope": {"file": "envelope.proto", "message": "Envelope", "oneof": "payload"},
        "ros": {"package": package},
        "peers": {"board": {}},
        "messages": [
            {
                "number": number,
                "name": name,
                "proto": name.title(),
                "topic": name,
                "direction": "ros_to_board",
                "deadman": {"after": "1s", "send": {"text": text, "raw": raw.hex()}},
            }
            for number, (name, _, text, raw) in enumerate(rows, 1)
        ],
    }
    proto = 'syntax = "proto3";\n'
    for name, comment, _, _ in rows:
        comments = "".join(f"// {line}\n" for line in comment.split("\n"))
        proto += f"""
            {comments} message {name.title()} {{
            {comments} string text = 1;
            bytes raw = 2;
            Part {name} = 3;
            message Part {{ int32 {name} = 1; }}
            }}
        """
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder)
        (project / "all.proto").write_text(proto, encoding="utf-8")
        (project / "mapping.yaml").write_text(yaml.safe_dump(table), encoding="utf-8")
        made = {path: text for path, text in compile_table(project / "mapping.yaml").files.items() if _is_ours(path)}
    assert made == _formatted(made)


@pytest.mark.slow
def test_ruff_finds_nothing(tmp_path: Path) -> None:
    """The linter, with this repository's settings, has nothing to say about the modules of any case."""
    for case in passing_cases():
        _write(tmp_path / case.name, files_of(case))
    lint = [sys.executable, "-m", "ruff", "check", "--no-cache", "--config", ROOT / "pyproject.toml"]
    packages = [f"{case.name}/{_folder(case)}" for case in passing_cases()]
    done = subprocess.run([*lint, "--config", "src = ['*']", *packages], cwd=tmp_path, capture_output=True, text=True)
    assert "All checks passed!" in done.stdout, done.stdout


@pytest.mark.slow
def test_mypy_finds_nothing(tmp_path: Path) -> None:
    """The type checker, as strict as for this repository, has nothing to say about the modules of any case.

    One run for all takes a tenth of the time. So the generated package of each case stands in a package of its name.
    """
    packages = []
    for case in passing_cases():
        if case.name not in _UNTYPED:
            module = _folder(case).replace("/", ".")
            inside = re.compile(rf"\b{re.escape(module)}\b(?=\.| import)")
            files = {path: inside.sub(f"{case.name}.{module}", text) for path, text in files_of(case).items()}
            _write(tmp_path / case.name, files)
            packages += ["--package", f"{case.name}.{module}"]
    (tmp_path / "roverlink").symlink_to(ROOT / "roverlink")
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--config-file",
        ROOT / "pyproject.toml",
        "--cache-dir",
        tmp_path / "cache",
    ]
    done = subprocess.run([*command, *packages], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


def _write(project: Path, files: dict[str, str]) -> None:
    """The project as its owner has it: the generated code beside the runtime that it imports."""
    project.mkdir(exist_ok=True)
    (project / "roverlink").symlink_to(ROOT / "roverlink")
    for path, text in files.items():
        target = project / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
