"""The bridge of a peer (``run --as``): over memory, with the rover's bridge at the other end of a link."""

from __future__ import annotations

import dataclasses
import socket
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from asking import asking_registry
from both_ends import BASE, LOGGER, BothEnds, copied_keys, has_handled
from bridge_rig import QUIET, changed, end, of_peers
from linked import linked_registry
from needs import needs_native
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos, Registry, SetupError
from roverlink.runtime.bridge.link_exchange import DIFFERS, SAME
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import NOT_PROVEN
from roverlink.runtime.core.handler import BoardStamp
from roverlink.runtime.core.mirror import end_named, mirrored
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.core.signing import Key, Signer, SigningClock
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.native.core import open_core
from roverlink.runtime.ros_arguments import parameters

_NUMBER = 23
_SIGNED = of_peers(dataclasses.replace(QUIET, signature=_NUMBER), basestation={"must_sign": True})
_COMMAND, _ROCK = (REGISTRY.by_name[name] for name in ("control_mode", "detected_object"))


_STAMPED = tuple(
    type("Stamped", (type(one),), {"board_stamp": BoardStamp(("x",), 1, 32)})() for one in REGISTRY.extra_topics
)
"""The extra topics as they would be if their stamps were by the clocks of boards."""


class _Ends(BothEnds):
    """Two bridges over memory, and a node that speaks at both ends."""

    def __init__(self, registry: Registry, **more: Any) -> None:
        graph = Graph()
        super().__init__(registry, lambda _: MemoryMiddleware(graph), **more)
        self.node = MemoryMiddleware(graph)

    def crosses(self, handler: Any, payload: dict[str, Any]) -> None:
        """Publish a message at its end until the node at the other end has it."""
        near, far = ("base", "rover") if handler.route.inbound else ("rover", "base")
        message, heard = handler.to_cdr(handler.payload_type(**payload)), list[bytes]()
        topic, kind = f"/{{}}/{handler.route.topic}".format, handler.message_type
        publisher = self.node.publisher(topic(near), kind, Qos())
        subscription = self.node.subscribe(topic(far), kind, Qos(), heard.extend)
        wait_until(lambda: publisher.publish([message]) and message in heard, f"{handler.route.name} at the other end")
        subscription.close()


def _tapped(relay: Any) -> list[bytes]:
    """The datagrams that a relay takes from now on."""
    seen, take = list[bytes](), relay._take
    relay._take = lambda datagram: (seen.append(datagram), take(datagram))
    return seen


def _offer(thief: socket.socket, bridge: Bridge, datagrams: list[bytes]) -> None:
    expected = bridge.account.received + len(datagrams)
    for datagram in datagrams:
        thief.sendto(datagram, ("127.0.0.1", bridge.port))
    wait_until(lambda: has_handled(bridge, expected), "the thief's datagrams")


def test_both_ends_sign_and_a_thief_moves_neither(tmp_path: Path) -> None:
    """Recordings, changed bits, the other direction, no signature, and a key of the same number: all are refused."""
    links = copied_keys(tmp_path, "basestation")
    with pytest.raises(SetupError, match="give a copy of the key file of 'basestation' that the rover has"):
        _Ends(_SIGNED, links=lambda one: open_links(one, [], LOGGER) if one.own else links(one))
    with _Ends(_SIGNED, links=links) as ends, socket.socket(type=socket.SOCK_DGRAM) as thief:
        down, up = _tapped(ends.to_base), _tapped(ends.to_rover)
        ends.crosses(_COMMAND, {"mode": 1})
        ends.crosses(_ROCK, {"frame_id": 5})
        ends.settle()
        published = [dict(bridge.account.published) for bridge in ends.bridges]
        dropped = [Counter(bridge.account.dropped) for bridge in ends.bridges]  # what the link has made late
        for bridge, own, other in ((ends.base, down, up), (ends.rover, up, down)):
            genuine = own[-1]
            stranger = Signer(_NUMBER, Key(genuine[-15], "x", bytes(32)), SigningClock(2**40)).sign(genuine[:-18])
            stolen = [genuine, own[0], genuine[:4] + bytes([genuine[4] ^ 1]) + genuine[5:]]
            stolen += [genuine[:-18], other[-1], other[-1][:-18], stranger]
            _offer(thief, bridge, stolen)
        assert [dict(bridge.account.published) for bridge in ends.bridges] == published
        for bridge, before in zip(ends.bridges, dropped):
            reasons = Counter(bridge.account.dropped) - before
            assert reasons.total() == 7
            assert reasons.keys() <= {reason.value for reason in NOT_PROVEN} | {"wrong_direction"}
        ends.crosses(_COMMAND, {"mode": 2})
        ends.crosses(_ROCK, {"frame_id": 6})


@pytest.mark.slow
@pytest.mark.parametrize("differs", [False, True])
def test_both_ends_compare_schemas_and_measure_the_link(differs: bool) -> None:
    """The rover's bridge knows who speaks, by rows that it forwards and others; a row that differs is refused."""
    registry = linked_registry()
    assert registry.link is not None
    hashes = {**registry.link.hashes, 5: 99} if differs else registry.link.hashes
    other = dataclasses.replace(registry, link=dataclasses.replace(registry.link, hashes=hashes))
    given = {"link_policy": "refuse"}
    with _Ends(registry, end=EndName("base"), of_base=other, **given) as ends:

        def reports() -> list[Any]:
            at_rover = [one for one in ends.rover.link_reports() if one.end == EndName("base")]
            found = [*at_rover, *ends.base.link_reports()]
            return found if all(one.statistics and one.loss_in is not None for one in found) else []

        base, rover = wait_until(reports, "link messages at both ends")
        assert (base.end, rover.end) == (EndName("base"), EndName("rover"))
        for one in (base, rover):
            assert (one.schema, one.differing) == ((DIFFERS, ("map",)) if differs else (SAME, ()))
            assert (one.untold, one.senders, one.lost_in) == ((), 1, 0)
        ends.crosses(registry.by_name["mode"], {"mode": 3})
        if not differs:
            ends.crosses(registry.by_name["map"], {"x": 4.0})


def test_the_rover_learns_the_port_of_its_peer() -> None:
    """A table without address and port of the peer: they are those from which its bridge sends."""
    learning = of_peers(QUIET, basestation=end("basestation", "learn", 0))
    with _Ends(learning, direct=True) as ends:
        ends.crosses(_COMMAND, {"mode": 1})
        own = (f"127.0.0.1:{ends.base.port}",)
        wait_until(lambda: ends.rover.link_states()[BASE].addresses == own, "the address")
        ends.crosses(_ROCK, {"frame_id": 5})


def test_both_ends_of_a_line(free_port: int) -> None:
    """The rover waits for a TCP connection, and the bridge of the basestation opens it."""
    line = f"tcp:127.0.0.1:{free_port}"
    with _Ends(of_peers(QUIET, basestation=end("basestation", line + "?listen")), direct=True) as ends:
        ends.base.change(parameters.read(ends.mirror, {"dst_ip": line}))
        ends.crosses(_COMMAND, {"mode": 1})
        ends.crosses(_ROCK, {"frame_id": 5})


def test_requests_of_a_node_at_the_other_end() -> None:
    """Its call goes over the link to the rover's service, and the response back; on a topic, each is once, too."""
    registry = asking_registry()
    find, found, measure = (registry.by_name[name] for name in ("find", "found", "measure"))
    service = measure.route.request.service  # type: ignore[union-attr]
    with _Ends(registry, end=EndName("base"), loss=0.3) as ends:
        responses: list[Any] = []

        def answer(data: bytes, respond: Any) -> None:
            respond(cdr.encode(service.response(length=cdr.decode(service.request, data).x / 2)))

        ends.node.offer("/rover/measure_rock", service, answer)
        client = ends.node.client("/base/measure_rock", service)
        for number in range(20):
            request = cdr.encode(service.request(x=number))
            assert client.call(request, lambda data: responses.append(cdr.decode(service.response, data)))
        wait_until(lambda: len(responses) == 20, "all responses")
        assert sorted(one.length for one in responses if not one.error) == [one / 2 for one in range(20)]
        ends.crosses(find, {"id": 5, "what": 1})
        ends.crosses(found, {"id": 5, "x": 1.0})


def test_what_a_mirrored_row_says() -> None:
    """A limit of the topic stays; that of what the rover sends is the rover's work, and so are stops and clocks."""
    registry = changed(changed(REGISTRY, "control_mode", max_rate=5), "rover_localization", max_rate=3, priority=2)
    registry = changed(registry, "imu_info", max_rate=4, expect_rate=50)
    base = mirrored(dataclasses.replace(registry, extra_topics=_STAMPED), BASE, 5000)
    assert base.extra_topics
    assert not base.board_stamps
    routes = {name: handler.route for name, handler in base.by_name.items()}
    rates = {name: (route.max_rate, route.inbound) for name, route in routes.items() if route.max_rate}
    assert rates == {"control_mode": (5, False), "imu_info": (4, True)}
    assert {(route.peer, route.board, route.forward, route.deadman) for route in routes.values()} == {
        ("rover", "", (), None)
    }
    assert base.own is not None
    assert base.own.left_out == ("arm_ctrl", "arm_target", "drive_motor")
    own = parameters.declarations(base)
    assert {"dst_ip", "rover_port", "listen_port"} <= own.keys()
    assert (own["listen_port"].default, own["rover_port"].default) == (6000, 5000)
    with pytest.raises(SetupError, match="unknown parameter 'forward_policy'"):
        parameters.read(base, {"forward_policy": "all"})


@needs_native
def test_the_native_core_stamps_at_the_other_end() -> None:
    """On the rover, Python stamps by the clock of a board; at the other end the stamp is the time of arrival."""
    rover = dataclasses.replace(REGISTRY, extra_topics=_STAMPED)
    base = mirrored(rover, BASE, 5000)
    at_rover, at_base = open_core(rover), open_core(base)
    inbound = [one for one in rover.extra_topics if one.route.inbound]
    assert {at_rover.reason(one) for one in inbound} == {"its stamps are by the clock of the board"}
    assert {at_base.reason(one) for one in base.extra_topics if one.route.inbound} == {""}


def test_an_end_that_one_bridge_cannot_be() -> None:
    """The whole peer, if its boards have addresses of their own; each of its boards can be."""
    boards = tuple(
        End(name, port_parameter=f"{name}_port", port=port) for name, port in (("ArmBoard", 1), ("Motors", 2))
    )
    registry = of_peers(REGISTRY, hardware={"boards": boards})
    with pytest.raises(
        SetupError, match="the boards of hardware have addresses of their own; name one of them: ArmBoard"
    ):
        mirrored(registry, end_named(registry, "hardware"), 5000)
    arm = mirrored(registry, end_named(registry, "ArmBoard"), 5000)
    assert arm.own is not None
    assert (arm.own.port, [*arm.by_name]) == (1, [name for name in REGISTRY.by_name if name.startswith("arm_")])
