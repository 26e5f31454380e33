"""Fixtures of the tests that call `roverlink`, of all products: their conftest.py imports them."""

from __future__ import annotations

import re
import signal
import socket
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from polling import PATIENCE_S
from programs import Program, Start
from running import Bridge, Called, exit_code


@pytest.fixture(autouse=True)
def own_signals() -> Iterator[None]:
    """A command that is called in this process leaves its signal handlers behind."""
    before = {
        number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
    }
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture(autouse=True)
def own_domain(monkeypatch: pytest.MonkeyPatch, environment: dict[str, str]) -> None:
    """The nodes of this process meet those of the programs that the test starts, and no others."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])


@pytest.fixture
def peer() -> Iterator[socket.socket]:
    """The UDP socket of a board, of the basestation, or of whoever a program sends to."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(PATIENCE_S)
        yield sock


@pytest.fixture
def bridge(start: Start) -> Bridge:
    """Starts a bridge on a free port of this host alone; the program, and its UDP port as soon as it listens there."""

    def bridge(
        *options: object, parameters: Sequence[str] = (), ros: Sequence[str] = (), command: str = "run", **more: Any
    ) -> tuple[Program, int]:
        middleware = more.pop("middleware", "memory")
        given = ("listen_port:=0", "listen_address:='127.0.0.1'", *parameters)
        words = [word for one in given for word in ("-p", one)]
        program = start(command, *options, "--middleware", middleware, "--ros-args", *words, *ros, **more)
        found = re.search(r"on UDP port (\d+)", program.wait_for("on UDP port "))
        assert found
        return program, int(found[1])

    return bridge


@pytest.fixture
def called(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Called:
    """Runs `roverlink` as the fixture `done` does, but in this process: exit code, standard output and error."""

    def called(*arguments: object, folder: Path = Path(__file__).parents[1]) -> tuple[int, str, str]:
        monkeypatch.chdir(folder)
        monkeypatch.setenv("COLUMNS", "200")
        capsys.readouterr()
        code = exit_code(*arguments)
        output, errors = capsys.readouterr()
        return code, output.removesuffix("\n"), errors.removesuffix("\n")

    return called
