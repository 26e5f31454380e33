"""Ctrl-C while a command starts: it ends cleanly, whatever it was importing."""

from __future__ import annotations

import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from polling import PATIENCE_S, wait_until

_ROOT = Path(__file__).parents[2]
_STARTS = 4  # the time in which the signal comes, in starts of Python with roverlink
_TIMES = 20
_COMMANDS = [
    *("--version", "--help", "generate --check", "lint", "lint --history", "explain imu_info", "number next"),
    *("number history 20", "listen --port 0", "echo imu_data --middleware memory", "simulate --to 127.0.0.1:9"),
    *("simulate --bridge memory", "top --once --middleware memory", "doctor --json", "init"),
    *("demo --seconds 2", "aruco board --help", "aruco track --help"),
    "run --middleware memory --ros-args -p listen_port:=0 --disable-rosout-logs",
    "send imu_info --to 127.0.0.1:9 --rate 1000 --count 1000",
    "pub imu_data {} --rate 10 --middleware memory",
    "record {tmp}/run.mcap --middleware memory --ros-args -p listen_port:=0",
]


def _interrupted(arguments: list[str], delay_s: float, folder: Path, environment: dict[str, str]) -> tuple[int, str]:
    """Start a command, interrupt it after a delay, and return its exit code and its standard error."""
    program = subprocess.Popen(
        [sys.executable, "-m", "roverlink", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        cwd=folder if arguments == ["init"] else _ROOT,
    )
    time.sleep(delay_s)  # no event to await: the signal shall come at any moment
    program.send_signal(signal.SIGINT)
    try:
        _, errors = program.communicate(timeout=PATIENCE_S)
    finally:
        program.kill()
    return program.returncode, errors


def _is_python_s_own(code: int, errors: str) -> bool:
    """True if the signal came while Python itself started or looked for `roverlink`, before any of our code ran."""
    # The environment with the other packages may be in a folder of the repository.
    ours = re.search(rf'File "{re.escape(str(_ROOT))}/(roverlink|generator|runtime|rover)/', errors)
    return (code in (1, -signal.SIGINT) or "KeyboardInterrupt" in errors) and not ours


@pytest.mark.exhaustive
@pytest.mark.parametrize("command", _COMMANDS)
def test_ctrl_c_at_any_moment_of_the_start_ends_a_command_cleanly(
    command: str, tmp_path: Path, environment: dict[str, str]
) -> None:
    """At random moments of the start, Ctrl-C gives no traceback, and tells whether the work was done."""
    moments = random.Random(command)  # noqa: S311  # repeatable, not secret
    began = time.monotonic()
    subprocess.run([sys.executable, "-m", "roverlink", "--version"], check=True, env=environment, cwd=_ROOT)
    window_s = _STARTS * (time.monotonic() - began)  # longer on a busy machine
    reached = 0
    for attempt in range(_TIMES):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        delay_s = moments.uniform(0, window_s)
        code, errors = _interrupted(command.replace("{tmp}", str(folder)).split(), delay_s, folder, environment)
        if not _is_python_s_own(code, errors):
            assert "Traceback" not in errors, f"after {delay_s:.3f} s:\n{errors}"
            assert code in (0, 130), f"after {delay_s:.3f} s:\n{errors}"
            reached += 1
    assert reached >= _TIMES // 2


@pytest.mark.slow
def test_a_program_in_the_background_of_a_script_goes_on_at_ctrl_c(environment: dict[str, str]) -> None:
    """A command that was started with SIGINT ignored, as a shell script does with `&`, is not ended by it."""
    line = f"trap '' INT; echo started; exec {sys.executable} -m roverlink number next"
    with subprocess.Popen(["sh", "-c", line], stdout=subprocess.PIPE, text=True, env=environment, cwd=_ROOT) as program:
        assert program.stdout
        assert program.stdout.readline() == "started\n"
        wait_until(lambda: program.send_signal(signal.SIGINT) or program.poll() is not None, "its end")
        assert program.stdout.read().strip().isdigit()
    assert program.returncode == 0
