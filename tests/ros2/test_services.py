"""Requests as ROS 2 services of a generated type, between a real rclpy node and peers."""

from __future__ import annotations

import json
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from asking import write_asking_project
from judge import Judge, interface, repeat
from polling import wait_until
from programs import Start

from roverlink.runtime import load_registry
from roverlink.runtime.client import BlockingPeer, UnansweredError

pytest.importorskip("asking_msgs", reason="`make test-ros2` builds this package")


def test_services_and_peers_answer_each_other(
    judge: Judge, start: Start, tmp_path: Path, free_udp_ports: Sequence[int]
) -> None:
    """Each call gets the response of the board, once, or an error; and a base gets the response of a service."""
    registry = load_registry(write_asking_project(tmp_path / "project"), "asking_rover")
    peers = dict(zip((peer.name for peer in registry.peers), free_udp_ports))
    ports = {one.port_parameter: peers[one.name] for one in registry.peers}
    words = [word for name, port in {"listen_port": 0, **ports}.items() for word in ("-p", f"{name}:={port}")]
    program = start("run", "--json", "--project", tmp_path / "project", "--middleware", "rclpy", "--ros-args", *words)
    port = json.loads(program.wait_for('"port"', program.output))["port"]
    program.wait_for("requests and responses are matched in Python: ")
    answer, carried_out, done = registry.by_name["gripped"].payload_type, list[float](), threading.Event()

    def be_a_board() -> None:
        with BlockingPeer.open("board", registry=registry, port=port, local_port=peers["board"]) as board:
            while not done.wait(0.005):
                for _, order in board.arrived():
                    if hasattr(order, "force"):
                        carried_out.append(order.force)
                        board.send(answer(id=order.id, force=order.force / 2))

    board = threading.Thread(target=be_a_board)
    board.start()
    try:
        _call_the_board(judge)
        assert sorted(carried_out)[-8:] == list(range(10, 18))
    finally:
        done.set()
        board.join()
    measure = registry.by_name["measure"].payload_type
    with BlockingPeer.open("base", registry=registry, port=port, local_port=peers["base"]) as base:
        _ask_from_a_base(judge, base, measure)
    assert program.interrupt() == 0


def _call_the_board(judge: Judge) -> None:
    grip, switch = interface("asking_msgs/srv/Grip"), interface("asking_msgs/srv/SwitchLight")
    client, first = judge.node.create_client(grip, "/grip"), list[Any]()
    judge.executor.wake()
    # As with any service, the first calls are lost until both ends know each other.
    one_is_answered = lambda: client.service_is_ready() and any(call.done() for call in first)  # noqa: E731
    repeat(lambda: first.append(client.call_async(grip.Request(force=3.0))), one_is_answered, "a response", 1.0)
    assert {(call.result().error, call.result().force) for call in first if call.done()} == {("", 1.5)}
    calls = [client.call_async(grip.Request(force=float(force))) for force in range(10, 18)]  # fewer than its queue
    wait_until(lambda: all(call.done() for call in calls), "the end of all calls")
    assert [call.result().force for call in calls] == [force / 2 for force in range(10, 18)]
    response = judge.call("/switch_light", "asking_msgs/srv/SwitchLight", switch.Request(on=True))
    assert response.error == "board has not answered light, which was sent 2 times"


def _ask_from_a_base(judge: Judge, base: BlockingPeer, measure_payload: Any) -> None:
    asked: list[int] = []

    def measure(request: Any, response: Any) -> Any:
        asked.append(request.x)
        response.length = request.x / 2
        return response

    with pytest.raises(UnansweredError):  # no node offers the service yet
        base.request(measure_payload(x=1))
    kind = interface("asking_msgs/srv/MeasureRock")
    judge.on_thread(lambda: judge.node.create_service(kind, "/measure_rock", measure))

    def length() -> float:
        with suppress(UnansweredError):  # the bridge does not know the service yet
            return float(base.request(measure_payload(x=5)).length)
        return 0.0

    assert wait_until(length, "the response of the service") == 2.5
    assert base.request(measure_payload(x=8)).length == 4
    assert asked.count(8) == 1
