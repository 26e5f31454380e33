"""README.md: the example finds what it shows."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from roverlink.__main__ import main

_README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def test_the_example_of_the_readme_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command prints the text beside the file, and ends with exit code 1."""
    (text,) = re.findall(r"^```yaml\n(.*?)^```", _README, re.DOTALL | re.MULTILINE)
    ((command, shown),) = re.findall(r"^\$ (check-launch .*?)\n(.*?)^```", _README, re.DOTALL | re.MULTILINE)
    (tmp_path / text.partition("\n")[0].removeprefix("# ")).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert main(command.split()) == 1
    assert capsys.readouterr().out == shown
