"""Files that run without end, or expand without end: one finding each, and the check goes on."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from roverlink.__main__ import main

_PYTHON = "import os, signal, subprocess, sys, threading, time\nfrom launch import LaunchDescription\n"
_FUNCTION = "\ndef generate_launch_description():\n    return LaunchDescription([])\n"
_INCLUDES = "launch:\n" + 2 * "- include: {{file: $(dirname)/{}.launch.yaml}}\n"
_BOMB = "launch:\n- let: {name: a, value: aaaaaaaaaa}\n" + 30 * "- let: {name: a, value: $(var a)$(var a)}\n"
_GROUPS = "<launch>" + 500 * "<group>" + 500 * "</group>" + "</launch>"
_ALIASES = "".join(f"{name}: &{name} [{', '.join(9 * [f'*{below}'])}]\n" for below, name in zip("abcdefg", "bcdefgh"))
_CASES: Mapping[str, tuple[Mapping[str, str | bytes], str]] = {
    **{
        name: ({"a.launch.py": _PYTHON + code + _FUNCTION}, finding)
        for name, (code, finding) in {
            "ends the process": ("os._exit(7)", "exit code 7"),
            "is ended by a signal": ("os.kill(os.getpid(), signal.SIGTERM)", "ended by SIGTERM"),
            "does not end": ("while True: pass", "longer than 0.2 s"),
            "waits without end": ("time.sleep(1000)", "waits longer than 0.2 s"),
            "leaves a thread": ("threading.Thread(target=time.sleep, args=[1000]).start()", ""),
            "takes all memory": ("x = [0] * 10**10", "MemoryError"),
            "writes a large file": ("open('x', 'wb').write(bytes(64 << 20))", "File too large"),
            "changes the folder, and starts a program": ("os.chdir('/'); subprocess.run(['true'], check=True)", ""),
            "asks the user": ("input()", ""),
            "needs what a user gives": ("sys.argv or 0\nnumber_of_robots", ""),
        }.items()
    },
    "is Python, whatever its name": ({"a.launch": _PYTHON + _FUNCTION}, ""),
    "imports what is not there": ({"a.launch.py": "from xml import Missing\n" + _PYTHON + _FUNCTION}, ""),
    "uses what is not known": ({"a.launch.py": "import std_msgs.msg as m; m.A()[0] = 1; -m.A()" + _FUNCTION}, ""),
    "waits for what is not known": ({"a.launch.py": "import std_msgs.msg as m\nwhile m.A()(): 0" + _FUNCTION}, ""),
    "returns nothing": ({"a.launch.py": "def generate_launch_description():\n    pass\n"}, "returns None"),
    "refuses to go on": ({"a.launch.py": "import sys; sys.exit(1)" + _FUNCTION}, ""),
    "is no launch file, and does not run": ({"a.launch.py": "import no_such_module"}, "has no function"),
    "needs a module": ({"a.launch.py": "import no_such_module\n" + _PYTHON + _FUNCTION}, ""),
    "includes twice, and so on": (
        {f"{i}.launch.yaml": _INCLUDES.format(i + 1, i + 1) for i in range(20)} | {"20.launch.yaml": "launch: []\n"},
        "included more than 1000 times",
    ),
    "doubles a text": ({"a.launch.yaml": _BOMB}, "grows without end"),
    "nests groups": ({"a.launch.xml": _GROUPS}, "nested too deeply"),
    "is nested deeply": ({"p.yaml": "a: " + 3000 * "{a: " + 3000 * "}"}, "nested too deeply"),
    "has anchors of anchors": ({"p.yaml": f"a: &a [1, 1, 1]\n{_ALIASES}"}, "anchors in place"),
    "has an anchor that contains itself": ({"p.yaml": "ekf_node: &a\n  ros__parameters: *a\n"}, "contains itself"),
    "is beside C++": ({"a.launch.xml": "<launch/>", "package.xml": "<name>a</name>", "a.h": "a" + 10**5 * " "}, ""),
    "is Latin-1": ({"p.yaml": "ekf_node: # H\xf6he\n  ros__parameters: {}\n".encode("latin-1")}, "not UTF-8"),
}


@pytest.mark.parametrize(("files", "finding"), _CASES.values(), ids=_CASES)
def test_a_file_that_does_not_end_well_gives_one_finding(
    files: Mapping[str, str | bytes],
    finding: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The finding has the name of the file and the reason; the check itself has no traceback."""
    monkeypatch.chdir(tmp_path)
    for name, text in files.items():
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    limit = "0.2" if "0.2 s" in finding else "20"  # what ends has the time that a busy computer needs
    code = main(["check-launch", "--format", "json", "--time-limit", limit, next(iter(files))])
    level = "hint" if "waits" in finding else "fatal"  # perhaps for a device, which is there on the robot
    ended = [one for one in json.loads(capsys.readouterr().out) if one["severity"] == level]
    assert [one["path"].endswith((".py", ".xml", ".yaml")) for one in ended] == [True] * bool(finding)
    assert all(finding in one["message"] for one in ended)
    assert code == (2 if finding and level == "fatal" else 0)


def test_what_colcon_builds_or_ignores_is_not_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In a workspace, only the sources count; a Python file whose name ends like one of a launch file does not run."""
    for folder in ("src/a/launch", "build/a", "install/a", "log", "src/old", ".git"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "a.launch.yaml").write_text("launch:\n- node: {pkg: nav2_amcl, exec: aml}\n")
    (tmp_path / "src" / "old" / "COLCON_IGNORE").touch()
    (tmp_path / "src" / "Debug.launch").write_text('<?xml version="1.0"?>\n<launchConfiguration type="of Eclipse"/>')
    (tmp_path / "src" / "a" / "test_launch.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    assert main(["check-launch", "--format", "json", str(tmp_path)]) == 1
    found = [one["path"] for one in json.loads(capsys.readouterr().out) if one["id"] == "LCH108"]
    assert [path.endswith("src/a/launch/a.launch.yaml") for path in found] == [True]
    assert not (tmp_path / "ran").exists()
