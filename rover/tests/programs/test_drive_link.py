"""``roverlink drive`` with a bridge whose links to the basestation and to the board lose datagrams, and are cut."""

from __future__ import annotations

import json
import socket
from contextlib import ExitStack
from typing import Any

import pytest
from needs import needs_dds
from network import arrived, bound
from polling import wait_until
from programs import Start
from relay import Relay
from repeating import repeated

from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.geometry_msgs import Twist, Vector3
from roverlink.runtime.middleware import NodeIdentity, open_middleware

_LOCAL = ("127.0.0.1", 0)
_LOSS = 0.05
_MODES = 400


def _distances(board: socket.socket) -> list[float]:
    """The distances of the drive commands that have arrived at a board since the last call."""
    envelopes: list[Any] = [REGISTRY.envelope.FromString(datagram) for datagram in arrived(board)]
    return [one.drive_motor.distance_to_go for one in envelopes if one.WhichOneof("payload") == "drive_motor"]


@pytest.mark.slow
@needs_dds
def test_losses_stop_nothing_and_the_operator_and_a_cut_link_do(
    start: Start, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """5 % of the datagrams are lost in both directions. After MANUAL and after the cut, no command moves the rover."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    with ExitStack() as held:
        board = held.enter_context(bound(_LOCAL))
        to_board = held.enter_context(Relay(bound(_LOCAL), board.getsockname(), 1, _LOSS, 0.0, 0.005))
        ros = ("listen_port:=0", "listen_address:='127.0.0.1'", f"dst_b_port:={to_board.address[1]}")
        bridge = start("run", "--middleware", "dds", "--ros-args", *(word for one in ros for word in ("-p", one)))
        port = int(bridge.wait_for("on UDP port ").rpartition(" ")[2])
        to_bridge = held.enter_context(Relay(bound(_LOCAL), ("127.0.0.1", port), 2, _LOSS, 0.0, 0.005))
        # Long enough for a machine that is busy with other things; the bench measures the times.
        given = ("mode_timeout:=4.0", "timeout:=4.0", "horizon:=4.0")
        drive = start(
            "drive", "--middleware", "dds", "--json", "--ros-args", *(w for one in given for w in ("-p", one))
        )
        drive.wait_for("while /control_mode is AUTO")
        node = held.enter_context(open_middleware("dds", NodeIdentity("controller")))
        velocities = node.publisher("/cmd_vel", Twist, Qos())
        held.enter_context(repeated(lambda _: velocities.publish([cdr.encode(Twist(Vector3(0.3)))]), 0.05))
        basestation = held.enter_context(bound(_LOCAL))
        mode: int | None = 1

        def tell(_: int) -> None:
            if mode is not None:
                datagram = REGISTRY.envelope(control_mode={"mode": mode}).SerializeToString()
                basestation.sendto(datagram, to_bridge.address)

        held.enter_context(repeated(tell, 0.02))
        wait_until(lambda: any(_distances(board)), "a command")
        told = to_bridge.taken + _MODES
        wait_until(lambda: to_bridge.taken > told, "many modes")
        arrived = _distances(board)
        assert len(arrived) > 20
        assert 0 not in arrived

        mode = 0
        drive.wait_for("manual: control_mode is MANUAL")
        # The deadman of the bridge now sends stops: the topic is silent.
        wait_until(lambda: 0 in _distances(board), "a stop")
        wait_until(lambda: 0 in (found := _distances(board)) and not any(found), "nothing but stops")

        mode = 1
        wait_until(lambda: any(_distances(board)), "a command")
        mode = None
        drive.wait_for("manual: no control_mode for ")
        wait_until(lambda: 0 in _distances(board), "a stop")
        wait_until(lambda: 0 in (found := _distances(board)) and not any(found), "nothing but stops")
        assert drive.interrupt() == 0
    entries = [*map(json.loads, drive.output)]
    assert entries[-1]["reason"] == "this program ends"
    states = [one["state"] for one in entries if "state" in one]
    assert states == ["manual", "idle", "driving", "manual", "idle", "driving", "manual", "manual"]
