"""A rover over zenoh whose link to the router is cut: the deadman stops it, and no old command follows."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from needs import NO_ZENOH
from network import BOARD, Network, arrived, bound, inside, ip, why_not
from polling import wait_until

from generated.registry import REGISTRY

pytestmark = [
    pytest.mark.skipif(bool(why_not()), reason=why_not()),
    pytest.mark.skipif(not find_spec("zenoh"), reason=NO_ZENOH),
]

_ROUTER = f"tcp/{BOARD}:7447"
_HELD_BACK_S = 1.5  # the most that a command may be late: a second, and what a busy computer adds
_BACK_S = 2.0  # after which a link is to work again
# Publishes the time in seconds since the start of the test, twenty times a second, as the distance to go.
_COMMANDER = """
import sys, time
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware
drive = REGISTRY.by_name["drive_motor"]
with open_middleware("zenoh", NodeIdentity("commander")) as node:
    publisher = node.publisher("/drive_motor", drive.message_type, Qos())
    while True:
        payload = drive.payload_type(distance_to_go=time.monotonic() - float(sys.argv[1]))
        publisher.publish([drive.to_cdr(payload)])
        time.sleep(0.05)
"""


class _Rig(contextlib.ExitStack):
    """Router and commander at one end of a cable, a bridge with a board at the other."""

    def __init__(self, environment: dict[str, str]) -> None:
        super().__init__()
        override = f'mode="client";connect/endpoints=["{_ROUTER}"]'
        self._environment = {**environment, "ZENOH_CONFIG_OVERRIDE": override}
        self.began = time.monotonic()

    def __enter__(self) -> _Rig:
        self.network = network = self.enter_context(Network())
        self.board = self.enter_context(contextlib.closing(inside(network.rover, lambda: bound(("127.0.0.1", 0)))))
        self._router = self._start(network.board, "-m", "roverlink", "zenoh-router", "--listen", _ROUTER)
        self._start(network.board, "-c", _COMMANDER, self.began)
        port = self.board.getsockname()[1]
        bridge = ("-m", "roverlink", "run", "--middleware", "zenoh", "--ros-args", "-p", f"dst_b_port:={port}")
        self._start(network.rover, *bridge)
        return self

    def _start(self, namespace: str, *words: object) -> subprocess.Popen[bytes]:
        """Run Python in a namespace, again and again until it finds the router; return the shell that does so."""
        command = ["ip", "netns", "exec", namespace, "sh", "-c", 'until "$@"; do sleep 0.2; done', "x", sys.executable]
        process = subprocess.Popen(
            [*command, *map(str, words)], env=self._environment, cwd=Path(__file__).parents[2], start_new_session=True
        )
        self.callback(lambda: (ip("netns", "pids", namespace), process.wait()))
        self.callback(lambda: subprocess.run(["kill", "-9", "--", f"-{process.pid}"], check=False))
        return process

    def kill_router(self) -> None:
        """Kill the router, which is then started again."""
        subprocess.run(["pkill", "-KILL", "-P", str(self._router.pid)], check=True)

    def commands(self) -> Iterator[tuple[float, float]]:
        """The commands that have come to the board: when each was given, and how old it is; a stop is given at 0."""
        for one in arrived(self.board):
            envelope = REGISTRY.envelope.FromString(one)
            if envelope.WhichOneof(REGISTRY.oneof) == "drive_motor":
                given = envelope.drive_motor.distance_to_go
                yield given, time.monotonic() - self.began - given


@pytest.mark.parametrize(
    "cut_s", [pytest.param(3.0, marks=pytest.mark.slow), pytest.param(60.0, marks=pytest.mark.exhaustive)]
)
def test_no_command_of_a_gap_is_obeyed(environment: dict[str, str], cut_s: float) -> None:
    """In the gap the board is told to stop; afterwards it gets new commands, and none that the link held back."""
    with _Rig(environment) as rig:
        wait_until(lambda: any(given for given, _ in rig.commands()), "a command")
        ip("-n", rig.network.board, "link", "set", "cable", "down")
        wait_until(lambda: any(given == 0 for given, _ in rig.commands()), "the stop")
        time.sleep(cut_s)
        assert not any(given for given, _ in rig.commands())
        ip("-n", rig.network.board, "link", "set", "cable", "up")
        back = time.monotonic()
        found: list[tuple[float, float]] = []
        wait_until(lambda: found.extend(one for one in rig.commands() if one[0]) or len(found) > 20, "new commands")
        back_after = sum(found[0]) + rig.began - back
        print(f"back after {back_after:.2f} s, ages {found[:3]}")
        assert back_after < 10 * _BACK_S
        assert max(age for _, age in found) < _HELD_BACK_S


@pytest.mark.slow
def test_a_router_that_is_killed_and_runs_again_delivers_new_commands_only(environment: dict[str, str]) -> None:
    """Bridge and commander survive it; the board is told to stop, and then gets new commands."""
    with _Rig(environment) as rig:
        wait_until(lambda: any(given for given, _ in rig.commands()), "a command")
        rig.kill_router()
        wait_until(lambda: any(given == 0 for given, _ in rig.commands()), "the stop")
        found: list[tuple[float, float]] = []
        wait_until(lambda: found.extend(one for one in rig.commands() if one[0]) or len(found) > 20, "new commands")
        assert max(age for _, age in found) < _HELD_BACK_S
