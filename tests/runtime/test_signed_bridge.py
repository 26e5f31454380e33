"""A bridge whose peers must sign: real UDP sockets, topics in memory, and key files on the disk."""

from __future__ import annotations

import dataclasses
import logging
import random
import socket
import threading
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pytest
from linked import linked_registry
from polling import PATIENCE_S, wait_until
from tables import changed, of_peers, unguarded

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Bridge, Qos, Registry, SetupError
from roverlink.runtime.bridge.bridge import Handle, Observer, Send
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.link_message import LinkWriter, new_session
from roverlink.runtime.core.signing import Key, Signer, SigningClock
from roverlink.runtime.keys.key_file import make_key_file
from roverlink.runtime.keys.signed_links import SignedLinks
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

NUMBER = 23
LOGGER = logging.getLogger("test_signed_bridge")
ALL_SIGN = {peer.name: {"must_sign": True} for peer in REGISTRY.peers}
COMMAND = REGISTRY.by_name["control_mode"]  # of the basestation
SENSOR = REGISTRY.by_name["ph_info"]  # of the hardware; it is forwarded to the basestation
PROGRESS = REGISTRY.by_name["drive_progress"]  # of a board of the hardware
MOTOR = REGISTRY.by_name["drive_motor"]  # to the hardware


def signing(peers: Mapping[str, dict[str, Any]] = ALL_SIGN, registry: Registry | None = None) -> Registry:
    """The table as it would be if these peers had to sign."""
    return of_peers(dataclasses.replace(registry or unguarded(REGISTRY), signature=NUMBER), **peers)


def datagram_of(handler: Any) -> bytes:
    """A datagram with a filled payload."""
    envelope = REGISTRY.envelope(**{handler.route.name: payload_at(handler.payload_type, 1.0)})
    return bytes(envelope.SerializeToString())


def changed_bit(datagram: bytes, place: int) -> bytes:
    """The datagram with one flipped bit."""
    return datagram[:place] + bytes([datagram[place] ^ 1]) + datagram[place + 1 :]


class Rig:
    """A bridge with its keys, and the peers, which have copies of the key files."""

    def __init__(self, folder: Path, registry: Registry, observers: Sequence[Observer] = (), **given: Any) -> None:
        self._stack = ExitStack()
        files = []
        for peer in registry.peers:
            files.append(folder / f"{peer.name}.keys")
            make_key_file(files[-1], peer.name, datetime.now(timezone.utc))
        bridge_keys = open_links(registry, files, LOGGER)
        assert bridge_keys is not None
        self._stack.enter_context(bridge_keys)
        self.links = {
            peer.name: SignedLinks(NUMBER, [file], LOGGER, peer.name) for peer, file in zip(registry.peers, files)
        }
        self.sockets = {peer.name: self._stack.enter_context(_socket()) for peer in registry.peers}
        ports = {peer.port_parameter: self.sockets[peer.name].getsockname()[1] for peer in registry.peers}
        values = {"listen_port": 0, "listen_address": "127.0.0.1", **ports, **given}
        self.graph = Graph()
        settings = parameters.read(registry, values)
        self.bridge = Bridge(
            registry, settings, MemoryMiddleware(self.graph), lambda topic: f"/{topic}", LOGGER, observers, bridge_keys
        )
        self.account = self.bridge.account
        self._thread = threading.Thread(target=self.bridge.run, daemon=True)

    def __enter__(self) -> Rig:
        self._stack.enter_context(self.bridge)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.stop()
        self._thread.join(PATIENCE_S)
        self._stack.close()
        assert not self.account.discrepancies()

    def signer(self, peer: str) -> Signer:
        """The signer of a peer."""
        signer = self.links[peer].signer(["ros"])
        assert signer is not None
        return signer

    def send(self, *datagrams: bytes) -> None:
        """Send as anyone, and wait until the bridge has handled all."""
        for start in range(0, len(datagrams), 100):
            received = self.account.received
            for datagram in datagrams[start : start + 100]:
                self.sockets["hardware"].sendto(datagram, ("127.0.0.1", self.bridge.port))
            wanted = received + len(datagrams[start : start + 100])
            wait_until(lambda wanted=wanted: self.handled >= wanted, f"{wanted} datagrams")  # type: ignore[misc]

    @property
    def handled(self) -> int:
        """Datagrams that were published, dropped, or link messages."""
        return self.account.published.total() + self.account.dropped.total() + self.account.links_received

    def arrived(self, peer: str) -> bytes:
        """The next datagram that a peer gets."""
        return self.sockets[peer].recv(65_536)

    def verdict(self, peer: str, datagram: bytes) -> str:
        """What a peer thinks of a datagram of the bridge."""
        try:
            self.links[peer].verifier.verify(datagram, {"ros"})
        except DatagramError as error:
            return error.reason.value
        return "accepted"

    def publish(self, handler: Any) -> None:
        """Publish a message as a ROS 2 node."""
        message = handler.to_cdr(payload_at(handler.payload_type, 1.0))
        MemoryMiddleware(self.graph).publisher(f"/{handler.route.topic}", handler.message_type, Qos()).publish(
            [message]
        )


def _socket() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    sock.settimeout(PATIENCE_S)
    return sock


def test_only_signed_commands_reach_their_topic(tmp_path: Path) -> None:
    """Each other datagram is dropped and counted by its reason, for the bridge and for the row."""
    with Rig(tmp_path, signing()) as rig:
        command, signer = datagram_of(COMMAND), rig.signer("basestation")
        early, signed, later = (signer.sign(command) for _ in range(3))
        stranger = Signer(NUMBER, Key(1, "basestation", bytes(32)), SigningClock())
        rig.send(signed, command, signed, changed_bit(later, 4), later[:-1] + bytes([later[-1] ^ 255]), early)
        rig.send(stranger.sign(command), later[:-18] + later[-18:-8], signed + b"\x08\x01", later + bytes(7))
        rig.send(
            rig.signer("hardware").sign(command), Signer(NUMBER, Key(99, "x", bytes(32)), SigningClock()).sign(command)
        )
        assert rig.account.published == {"control_mode": 2}
        dropped = {reason: count for reason, count in rig.account.dropped.items() if count}
        assert dropped == {
            "unsigned": 1,
            "replayed": 1,
            "wrong_signature": 4,
            "outdated": 1,
            "malformed_signature": 1,
            "wrong_key": 1,
            "unknown_key": 1,
        }
        assert {row for row, _ in rig.account.dropped_of_row} == {"control_mode"}


def test_peers_that_need_not_sign_go_on_as_before(tmp_path: Path) -> None:
    """The boards speak without signatures beside a basestation that signs."""
    with Rig(tmp_path, signing({"basestation": {"must_sign": True}})) as rig:
        rig.send(datagram_of(SENSOR), datagram_of(COMMAND))
        assert rig.account.published == {"ph_info": 1}
        assert rig.account.dropped == {"unsigned": 1}
        rig.publish(MOTOR)
        assert (
            rig.arrived("hardware")
            == REGISTRY.envelope(drive_motor=payload_at(MOTOR.payload_type, 1.0)).SerializeToString()
        )


def test_link_messages_are_signed_as_commands_are(tmp_path: Path) -> None:
    """A stranger cannot say that a board has another schema; a peer that need not sign says it without a signature."""
    registry = of_peers(dataclasses.replace(linked_registry(), signature=NUMBER), hardware={"must_sign": True})
    board, base = (LinkWriter(registry.envelope, new_session(), {number: 7}) for number in (1, 4))
    with Rig(tmp_path, registry, link_policy="refuse") as rig:
        assert rig.verdict("hardware", rig.arrived("hardware")) == "accepted"
        rig.send(board.write(1))
        assert (rig.account.dropped, rig.account.other_schemas) == ({"unsigned": 1}, {})
        rig.send(rig.signer("hardware").sign(board.write(2)), base.write(3))
        assert rig.account.other_schemas == {"Arm of hardware": ["arm_state"], "base": ["mode"]}
        assert rig.account.dropped == {"unsigned": 1}


def test_a_client_with_the_key_file_signs_and_verifies(tmp_path: Path) -> None:
    """`key_files` is all that a program has to add; without the key it ends before it sends anything."""
    registry = signing({"basestation": {"must_sign": True}})
    with pytest.raises(SetupError, match=r"'basestation' must sign .* no key file is given"):
        BlockingPeer.open("basestation", registry=registry)
    with ExitStack() as stack:
        port = _free_port()
        rig = stack.enter_context(Rig(tmp_path, registry, dst_a_port=port))
        keys = {"key_files": [tmp_path / "basestation.keys"]}
        options: dict[str, Any] = {"registry": registry, "port": rig.bridge.port, "local_port": port, **keys}
        peer = stack.enter_context(BlockingPeer.open("basestation", **options))
        peer.send(payload_at(COMMAND.payload_type, 1.0))
        wait_until(lambda: rig.account.published == {"control_mode": 1}, "the command")
        rig.send(datagram_of(SENSOR))
        assert peer.receive(SENSOR.payload_type, PATIENCE_S) == payload_at(SENSOR.payload_type, 1.0)
        with _socket() as stranger:
            stranger.sendto(datagram_of(SENSOR), ("127.0.0.1", port))
        wait_until(lambda: peer.arrived() == [] and peer.traffic.dropped == {"unsigned": 1}, "the stranger's datagram")


@pytest.mark.parametrize("owner", ["DrivingBoard", "hardware"])
def test_a_client_that_is_a_board_signs_with_its_key_or_with_that_of_its_peer(tmp_path: Path, owner: str) -> None:
    """The bridge finds a valid signature, whichever of the two keys the board has."""
    registry, file = signing({"hardware": {"must_sign": True}}), tmp_path / "one.keys"
    make_key_file(file, owner, datetime.now(timezone.utc))
    verifier = SignedLinks(NUMBER, [file], LOGGER).verifier
    with _socket() as bridge:
        options: dict[str, Any] = {"registry": registry, "port": bridge.getsockname()[1], "local_port": 0}
        with BlockingPeer.open("hardware", board="DrivingBoard", key_files=[file], **options) as board:
            board.send(payload_at(PROGRESS.payload_type, 1.0))
            verifier.verify(bridge.recv(65_536), {"hardware", "DrivingBoard"})


def test_the_key_of_another_board_is_no_help(tmp_path: Path) -> None:
    """A board without a key of its own, or of its peer, ends before it sends anything."""
    registry, file = signing({"hardware": {"must_sign": True}}), tmp_path / "one.keys"
    make_key_file(file, "DrivingBoard", datetime.now(timezone.utc))
    with pytest.raises(SetupError, match="no key with which ArmBoard of hardware signs"):
        BlockingPeer.open("hardware", board="ArmBoard", registry=registry, key_files=[file])


def _free_port() -> int:
    with _socket() as sock:
        port: int = sock.getsockname()[1]
        return port


@pytest.mark.parametrize("strips", [False, True])
def test_what_goes_to_a_peer_that_must_sign_is_signed(tmp_path: Path, strips: bool) -> None:
    """The board accepts each command once, also if it gets its datagrams without trailing zeros."""
    peers = {"hardware": {"must_sign": True, "strip_trailing_zeros": strips}}
    with Rig(tmp_path, signing(peers)) as rig:
        for _ in range(20):
            rig.publish(MOTOR)
            datagram = rig.arrived("hardware")
            assert datagram[-1] != 0 or not strips
            assert [rig.verdict("hardware", datagram) for _ in range(2)] == ["accepted", "replayed"]
            assert restore(datagram)[: -(3 + 15)] == datagram_of(MOTOR)


def test_each_stop_has_a_signature_of_its_own(tmp_path: Path) -> None:
    """The stop of a silent topic is sent again and again; the board must not take it for a replay."""
    registry = changed(
        REGISTRY, "drive_motor", deadman=dataclasses.replace(MOTOR.route.deadman, after_ms=10, repeat_ms=10)
    )
    with Rig(tmp_path, signing(registry=registry)) as rig:
        for _ in range(5):
            assert rig.verdict("hardware", rig.arrived("hardware")) == "accepted"


def test_a_forwarded_datagram_has_the_signature_of_the_bridge_behind_that_of_its_sender(tmp_path: Path) -> None:
    """The receiver verifies the bridge's signature; whoever has the sender's key can verify the other one, too."""
    with Rig(tmp_path, signing()) as rig:
        sent = rig.signer("hardware").sign(datagram_of(SENSOR))
        rig.send(sent + bytes(5))
        forwarded = rig.arrived("basestation")
        assert forwarded[: len(sent)] == sent
        assert rig.verdict("basestation", forwarded) == "accepted"
        assert REGISTRY.envelope.FromString(forwarded).WhichOneof("payload") == "ph_info"


def test_a_datagram_that_is_refused_is_not_forwarded(tmp_path: Path) -> None:
    """The bridge must not vouch for it."""
    with Rig(tmp_path, signing()) as rig:
        signer = rig.signer("hardware")
        rig.send(datagram_of(SENSOR), changed_bit(signer.sign(datagram_of(SENSOR)), 3))
        assert not rig.account.forwarded


def test_the_raw_repeater_does_not_sign(tmp_path: Path) -> None:
    """With forward_policy all, the bridge sends bytes that it does not understand, so it cannot vouch for them."""
    with Rig(tmp_path, signing(), forward_policy="all") as rig:
        rig.send(datagram_of(SENSOR))
        assert rig.arrived("basestation") == datagram_of(SENSOR)


def test_sources_and_signatures_work_together(tmp_path: Path) -> None:
    """An address that may speak for a peer must sign as well."""
    peers = {name: {"must_sign": True, "sources": ("127.0.0.0/8",)} for name in ALL_SIGN}
    with Rig(tmp_path, signing(peers)) as rig:
        rig.send(datagram_of(COMMAND), rig.signer("basestation").sign(datagram_of(COMMAND)))
        assert (rig.account.published.total(), rig.account.dropped) == (1, {"unsigned": 1})


class _Tap:
    def __init__(self) -> None:
        self.received: list[bytes] = []
        self.sent: list[bytes] = []

    def receiving(self, handle: Handle) -> Handle:
        """Keep what comes in."""

        def kept(batch: list[bytes]) -> None:
            self.received += batch
            handle(batch)

        return kept

    def sending(self, peer: str, send: Send) -> Send:
        """Keep what goes out."""

        def kept(datagrams: Sequence[bytes]) -> int:
            self.sent += datagrams
            return send(datagrams)

        return kept


def test_a_recording_cannot_be_replayed(tmp_path: Path) -> None:
    """A recorder sees received datagrams with their signatures, which are old; and sent ones without."""
    tap = _Tap()
    with Rig(tmp_path, signing(), [tap]) as rig:
        signer = rig.signer("basestation")
        rig.send(*(signer.sign(datagram_of(COMMAND)) for _ in range(5)))
        rig.publish(MOTOR)
        rig.arrived("hardware")
        recorded = [*tap.received]
        assert tap.sent == [datagram_of(MOTOR)]
        rig.send(*recorded)
        assert rig.account.published == {"control_mode": 5}
        assert rig.account.dropped == {"outdated": 4, "replayed": 1}


def test_a_missing_key_is_an_error_at_the_start() -> None:
    """The error names the peer and the command that makes its keys."""
    settings = parameters.read(REGISTRY, {"listen_port": 0})
    with pytest.raises(
        SetupError, match=r"datagrams of .*'basestation' must be signed .*roverlink link keygen basestation"
    ):
        Bridge(signing({"basestation": {"must_sign": True}}), settings, MemoryMiddleware(Graph()), str, LOGGER)


def test_boards_at_one_address_need_a_key_of_their_peer_for_link_messages(tmp_path: Path) -> None:
    """Each board has a key, but the bridge's link messages go to all of them: unsigned ones would be sent."""
    registry = signing({"hardware": {"must_sign": True}}, linked_registry())
    files = [tmp_path / f"{board}.keys" for board in ("Arm", "Drive")]
    for file in files:
        make_key_file(file, file.stem, datetime.now(timezone.utc))
    links = open_links(registry, files, LOGGER)
    settings = parameters.read(registry, {"listen_port": 0})
    with pytest.raises(SetupError, match=r"datagrams of 'hardware' must be signed .*roverlink link keygen hardware"):
        Bridge(registry, settings, MemoryMiddleware(Graph()), lambda topic: f"/{topic}", LOGGER, links=links)


def test_a_key_file_without_signing_is_an_error(tmp_path: Path) -> None:
    """Whoever gives a key expects signatures."""
    with pytest.raises(SetupError, match="the table has no `signing`"):
        open_links(REGISTRY, [tmp_path / "x.keys"], LOGGER)


def _hostile(stock: Sequence[bytes], count: int) -> Iterator[bytes]:
    """Forged, replayed and truncated datagrams, made from accepted ones."""
    generator = random.Random(20)  # noqa: S311  # a failing run must be repeatable
    forger = Signer(NUMBER, Key(1, "x", generator.randbytes(32)), SigningClock())
    for _ in range(count):
        whole = generator.choice(stock)
        place = generator.randrange(len(whole))
        yield generator.choice(
            (
                whole,
                changed_bit(whole, place),
                whole[:place],
                forger.sign(whole[:-18]),
                whole[:-18] + generator.randbytes(18),
                whole[:-15] + generator.randbytes(15),
                whole[:-18] + whole[-18:-8] + generator.randbytes(8),
                whole + generator.choice(stock),
                whole[:-18],
            )
        )


def _stock(rig: Rig) -> list[bytes]:
    """Datagrams of all payloads of all peers that the bridge has accepted."""
    inbound = [handler for handler in REGISTRY.handlers if handler.route.inbound]
    stock = [rig.signer(handler.route.peer).sign(datagram_of(handler)) for handler in inbound for _ in range(5)]
    rig.send(*stock)
    assert rig.account.published.total() == len(stock)
    return stock


def test_forged_replayed_and_truncated_datagrams_are_counted_and_never_accepted(tmp_path: Path) -> None:
    """Over the socket: what is not an accepted datagram is a counted one."""
    with Rig(tmp_path, signing()) as rig:
        stock = _stock(rig)
        rig.send(*_hostile(stock, 5_000))
        assert rig.account.published.total() == len(stock)
        assert rig.account.dropped.total() == 5_000


@pytest.mark.slow
def test_a_million_hostile_datagrams(tmp_path: Path) -> None:
    """None accepted, none uncounted; each reason occurs. In batches to the bridge itself, as the socket gives them."""
    rig = Rig(tmp_path, signing())
    with rig:
        stock = _stock(rig)
    batch: list[bytes] = []
    for datagram in _hostile(stock, 1_000_000):
        batch.append(datagram)
        if len(batch) == 8:
            rig.bridge._handle(batch)
            batch = []
    assert rig.account.published.total() == len(stock)
    assert rig.account.dropped.total() == 1_000_000
    assert not rig.account.discrepancies()
    reasons = Counter(reason for reason, count in rig.account.dropped.items() if count)
    assert {
        "unsigned",
        "malformed_signature",
        "wrong_signature",
        "unknown_key",
        "replayed",
        "outdated",
    } <= reasons.keys()
