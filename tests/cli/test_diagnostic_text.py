"""Every command shows diagnostics alike: place, source line, caret; in colour on a terminal only."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from case_file import usual_table

from roverlink.__main__ import main
from roverlink.diagnostic_text import Sources, show
from roverlink.generator.diagnostics import Rule, Span

_ROW = "  - {number: 1, name: imu, proto: Imu, topic: imu, direction: bord_to_ros}"
_TABLE = usual_table(f"messages:\n{_ROW}\n")
_SHOWN = f"""\
mapping.yaml:7:63: error[TAB103] unknown direction 'bord_to_ros' (known: board_to_ros, ros_to_board)
7 | {_ROW}
  |                                                               ^
  help: did you mean 'board_to_ros'?
"""


class _Example(Rule, id="XYZ101"):
    """An example."""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with one wrong direction, as the current folder."""
    (tmp_path / "mapping.yaml").write_text(_TABLE, encoding="utf-8")
    (tmp_path / "proto").mkdir()
    (tmp_path / "proto" / "imu.proto").write_text('syntax = "proto3";\nmessage Imu { float x = 1; }\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [["generate"], ["generate", "--check"], ["lint"], ["number", "retire", "2"], ["explain", "imu"]],
    ids=" ".join,
)
def test_all_commands_show_the_line(project: Path, command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """The text is the same, whichever command found the mistake; another folder names the file from there."""
    if "retire" in command:
        row = "  - {number: 2, name: old, proto: Imu, topic: old, direction: board_to_ros}\n"
        (project / "mapping.yaml").write_text(_TABLE + row, encoding="utf-8")
    assert main(command) == 1
    said = capsys.readouterr()
    assert _SHOWN in said.out + said.err


@pytest.mark.slow
def test_known_hints_hide_no_error(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`generate` shows the error, and of what the table lowers to a hint only the number and the rules."""
    row = "  - {number: 2, name: old, proto: Imu, topic: imu, direction: board_to_ros}\n"
    lowered = "lint: {TAB102: {severity: hint, reason: two boards send it}}\n"
    (project / "mapping.yaml").write_text(_TABLE.replace("bord_", "board_") + row + lowered, encoding="utf-8")
    assert main(["generate"]) == 0
    summed = "1 hint (TAB102), which `roverlink lint` shows\n"
    assert capsys.readouterr().err == summed
    (project / "mapping.yaml").write_text(_TABLE.replace("bord_", "board_") + row + lowered + "more: 1\n")
    assert main(["generate"]) == 1
    assert capsys.readouterr().err.endswith(f"{summed}1 error; nothing was written\n")


def test_a_row_that_is_not_on_disk_is_quoted(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`add` quotes the row that it would write."""
    assert main(["add", "wind", "--proto", "Imu", "--direction", "gale_to_ros"]) == 1
    row = "8 |   - {number: 2, name: wind, proto: Imu, topic: wind, direction: gale_to_ros}\n"
    assert row in capsys.readouterr().err


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("stream", "no_colour", "coloured"), [(_Terminal, "", True), (_Terminal, "1", False), (io.StringIO, "", False)]
)
def test_colour_is_for_terminals(
    stream: type[io.StringIO], no_colour: str, coloured: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file, a pipe and NO_COLOR get plain text."""
    for name in ("FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", no_colour)
    file, rule = stream(), _Example
    show([rule.at(Span("nowhere.yaml", 1, 1), "it is wrong")], Sources(Path()), file)
    assert ("\x1b[31m" in file.getvalue() or "\x1b[1;31m" in file.getvalue()) == coloured
