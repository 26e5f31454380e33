"""Requests as ROS 2 services of a generated type, between a real rclpy node and peers that lose datagrams."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any

import pytest
from asking import write_asking_project
from judge import Judge, interface, repeat
from polling import wait_until
from programs import Program, Start

from roverlink.runtime import Registry, load_registry
from roverlink.runtime.client import BlockingPeer, UnansweredError

pytest.importorskip("asking_msgs", reason="`make test-ros2` builds this package")


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the table with requests."""
    return write_asking_project(tmp_path_factory.mktemp("asking") / "project")


@pytest.fixture(scope="module")
def registry(project: Path) -> Registry:
    """The registry of the table."""
    return load_registry(project, "asking_rover")


@pytest.fixture
def peers(registry: Registry) -> dict[str, int]:
    """Free ports of the peers, by the parameters of the bridge."""
    ports = {}
    for peer in registry.peers:
        with BlockingPeer.open(peer.name, registry=registry, local_port=0) as free:
            ports[peer.port_parameter] = free.port
    return ports


class _Deaf:
    """Loses the first datagrams that come in."""

    def __init__(self, count: int) -> None:
        self._left = count

    def outgoing(self, datagram: bytes) -> bytes:
        """Change nothing."""
        return datagram

    def incoming(self, datagram: bytes) -> bytes | None:
        """Lose the datagram, or not any more."""
        self._left -= 1
        return None if self._left >= 0 else datagram


def _run(start: Start, middleware: str, project: Path, ports: dict[str, int]) -> tuple[Program, int]:
    given = [word for name, port in {"listen_port": 0, **ports}.items() for word in ("-p", f"{name}:={port}")]
    program = start("run", "--json", "--project", project, "--middleware", middleware, "--ros-args", *given)
    return program, json.loads(program.wait_for('"port"', program.output))["port"]


def test_services_and_peers_answer_each_other(
    judge: Judge, start: Start, project: Path, registry: Registry, peers: dict[str, int]
) -> None:
    """A call gets the response of a board that was deaf at first, once, or an error; a base gets that of a service."""
    program, port = _run(start, "rclpy", project, peers)
    program.wait_for("requests and responses are matched in Python: ")
    carried_out: list[float] = []
    done = threading.Event()

    def be_a_board() -> None:
        local, answer = peers[registry.peers_by_name["board"].port_parameter], registry.by_name["gripped"].payload_type
        with BlockingPeer.open("board", registry=registry, port=port, local_port=local, hooks=[_Deaf(2)]) as board:
            while not done.is_set():
                for number, order in board.arrived():
                    if number == registry.by_name["grip"].route.number:
                        carried_out.append(order.force)
                        board.send(answer(id=order.id, force=order.force / 2))
                done.wait(0.005)

    board = threading.Thread(target=be_a_board)
    board.start()
    try:
        grip = interface("asking_msgs/srv/Grip")
        client = judge.node.create_client(grip, "/grip")
        judge.executor.wake()
        first: list[Any] = []  # as with any service: the first ones are lost until both ends know each other
        repeat(
            lambda: first.append(client.call_async(grip.Request(force=3.0))),
            lambda: client.service_is_ready() and any(call.done() for call in first),
            "a response",
            1.0,
        )
        assert {(call.result().error, call.result().force) for call in first if call.done()} == {("", 1.5)}
        calls = [client.call_async(grip.Request(force=float(force))) for force in range(10, 18)]  # fewer than its queue
        wait_until(lambda: all(call.done() for call in calls), "the end of all calls")
        assert [call.result().force for call in calls] == [force / 2 for force in range(10, 18)]
        assert sorted(carried_out)[-8:] == list(range(10, 18))
        switch = interface("asking_msgs/srv/SwitchLight")
        response = judge.call("/switch_light", "asking_msgs/srv/SwitchLight", switch.Request(on=True))
        assert response.error == "board has not answered light, which was sent 2 times"
    finally:
        done.set()
        board.join()
    _ask_from_the_base(judge, port, registry, peers)
    assert program.interrupt() == 0


def _ask_from_the_base(judge: Judge, port: int, registry: Registry, peers: dict[str, int]) -> None:
    asked: list[int] = []

    def measure(request: Any, response: Any) -> Any:
        asked.append(request.x)
        response.length = request.x / 2
        return response

    local, measuring = peers[registry.peers_by_name["base"].port_parameter], registry.by_name["measure"].payload_type
    with BlockingPeer.open("base", registry=registry, port=port, local_port=local) as base:
        with pytest.raises(UnansweredError):  # no node offers the service yet
            base.request(measuring(x=1))
        judge.on_thread(
            lambda: judge.node.create_service(interface("asking_msgs/srv/MeasureRock"), "/measure_rock", measure)
        )

        def length() -> float:
            try:
                return float(base.request(measuring(x=5)).length)
            except UnansweredError:  # the bridge does not know the service yet
                return 0.0

        assert wait_until(length, "the response of the service") == 2.5
        assert base.request(measuring(x=8)).length == 4
    assert asked.count(8) == 1


@pytest.mark.parametrize("cyclone", [False, True])
def test_dds_offers_services_to_clients_that_get_a_response(
    judge: Judge, start: Start, project: Path, peers: dict[str, int], environment: dict[str, str], cyclone: bool
) -> None:
    """A service for Cyclone clients has the name and type of ROS 2; without them, a line says why there is none."""
    if cyclone:
        environment["RMW_IMPLEMENTATION"] = "rmw_cyclonedds_cpp"
    program, _ = _run(start, "dds", project, peers)
    judge.wait_for_node("/udp_forwarder")
    if not cyclone:
        program.wait_for(
            "the service /grip is not offered: with the middleware dds, only clients with RMW_IMPLEMENTATION="
        )
        return
    wanted = ("/grip", ["asking_msgs/srv/Grip"])
    wait_until(lambda: wanted in judge.node.get_service_names_and_types_by_node("udp_forwarder", "/"), "the service")
