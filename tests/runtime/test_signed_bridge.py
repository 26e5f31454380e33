"""A bridge whose peers must sign: real UDP sockets, topics in memory, and key files on the disk."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pytest
from bridge_rig import INBOUND, LOGGER, QUIET, Rig, end, envelope, listener, of_peers, port_of
from linked import linked_registry
from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.bridge.link_exchange import EndReport
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.link_message import LinkWriter, new_session
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.core.signing import TICKS_PER_SECOND, Key, Signer, SigningClock
from roverlink.runtime.keys.key_file import make_key_file, read_keys
from roverlink.runtime.keys.signed_links import SignedLinks

NUMBER = 23
ALL_SIGN = {peer.name: {"must_sign": True} for peer in REGISTRY.peers}
COMMAND = REGISTRY.by_name["control_mode"]  # of the basestation
SENSOR = REGISTRY.by_name["ph_info"]  # of the hardware; it is forwarded to the basestation
MOTOR = REGISTRY.by_name["drive_motor"]  # to the hardware


def signing(peers: Mapping[str, dict[str, Any]] = ALL_SIGN, registry: Registry = QUIET) -> Registry:
    """The table as it would be if these peers had to sign."""
    return of_peers(dataclasses.replace(registry, signature=NUMBER), **peers)


def datagram_of(handler: Any) -> bytes:
    """A datagram with a filled payload."""
    return envelope(**{handler.route.name: payload_at(handler.payload_type, 1.0)})


def changed_bit(datagram: bytes, place: int) -> bytes:
    """The datagram with one flipped bit."""
    return datagram[:place] + bytes([datagram[place] ^ 1]) + datagram[place + 1 :]


def _key_files(folder: Path, *owners: str) -> list[Path]:
    files = [folder / f"{owner}.keys" for owner in owners]
    for file in files:
        make_key_file(file, file.stem, datetime.now(timezone.utc))
    return files


class SignedRig(Rig):
    """A bridge with its keys, and the peers, which have copies of the key files."""

    def __init__(self, folder: Path, registry: Registry, boards: Sequence[str] = (), **given: Any) -> None:
        files = _key_files(folder, *(peer.name for peer in registry.peers), *boards)
        self.links = {file.stem: SignedLinks(NUMBER, [file], LOGGER, file.stem) for file in files}
        keys = open_links(registry, files, LOGGER)
        assert keys is not None
        super().__init__(registry, links=keys, **given)
        self.stack.enter_context(keys)

    def signer(self, peer: str) -> Signer:
        """The signer of a peer."""
        signer = self.links[peer].signer(["ros"])
        assert signer is not None
        return signer

    def verdict(self, peer: str, datagram: bytes) -> str:
        """What a peer thinks of a datagram of the bridge."""
        try:
            self.links[peer].verifier.verify(datagram, {"ros"})
        except DatagramError as error:
            return error.reason.value
        return "accepted"

    def next(self, peer: str) -> bytes:
        """The next datagram that a peer gets."""
        return self.peers[peer].recv(65_536)

    def dropped(self) -> dict[str, int]:
        """The reasons that occurred."""
        return {reason: count for reason, count in self.account.dropped.items() if count}


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[SignedRig]:
    """A bridge whose peers must all sign."""
    with SignedRig(tmp_path, signing()) as rig:
        yield rig


# --- from peers -------------------------------------------------------------------------------------------------


def test_only_signed_commands_reach_their_topic(rig: SignedRig) -> None:
    """Each other datagram is dropped and counted by its reason, for the bridge and for the row."""
    command, signer = datagram_of(COMMAND), rig.signer("basestation")
    early, signed, later = (signer.sign(command) for _ in range(3))
    stranger, unknown = (Signer(NUMBER, Key(key, "x", bytes(32)), SigningClock()) for key in (1, 99))
    rig.receive(signed, command, signed, changed_bit(later, 4), later[:-1] + bytes([later[-1] ^ 255]), early)
    rig.receive(stranger.sign(command), later[:-18] + later[-18:-8], signed + b"\x08\x01", later + bytes(7))
    rig.receive(rig.signer("hardware").sign(command), unknown.sign(command))
    assert rig.account.published == {"control_mode": 2}
    once = ("unsigned", "replayed", "outdated", "malformed_signature", "wrong_key", "unknown_key")
    assert rig.dropped() == {**dict.fromkeys(once, 1), "wrong_signature": 4}
    assert {row for row, _ in rig.account.dropped_of_row} == {"control_mode"}


def test_peers_that_need_not_sign_go_on_as_before(tmp_path: Path) -> None:
    """The boards speak without signatures beside a basestation that signs."""
    with SignedRig(tmp_path, signing({"basestation": {"must_sign": True}})) as rig:
        rig.receive(datagram_of(SENSOR), datagram_of(COMMAND))
        assert (rig.account.published, rig.dropped()) == ({"ph_info": 1}, {"unsigned": 1})
        assert rig.publish("drive_motor") == rig.next("hardware")


def test_link_messages_are_signed_as_commands_are(tmp_path: Path) -> None:
    """A stranger cannot say that a board has another schema; a peer that need not sign says it of what it gets, too."""
    registry = signing({"hardware": {"must_sign": True}}, linked_registry())
    board, base = (LinkWriter(registry.envelope, new_session(), hashes) for hashes in ({2: 7}, {4: 7, 1: 7}))
    with SignedRig(tmp_path, registry, link_policy="refuse") as rig:
        assert rig.verdict("hardware", rig.next("hardware")) == "accepted"
        rig.receive(board.write(1))
        assert (rig.account.dropped, rig.account.other_schemas) == ({"unsigned": 1}, {})
        rig.receive(rig.signer("hardware").sign(board.write(2)), base.write(3))
        assert rig.account.other_schemas == {"Drive of hardware": ["drive_state"], "base": ["arm_state", "mode"]}
        assert rig.account.dropped == {"unsigned": 1}


# --- to peers ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("strips", [False, True])
def test_what_goes_to_a_peer_that_must_sign_is_signed(tmp_path: Path, strips: bool) -> None:
    """The board accepts each command once, also if it gets its datagrams without trailing zeros."""
    peers = {"hardware": {"must_sign": True, "strip_trailing_zeros": strips}}
    with SignedRig(tmp_path, signing(peers)) as rig:
        for _ in range(20):
            plain = rig.publish("drive_motor", payload_at(MOTOR.payload_type, 1.0))
            datagram = rig.next("hardware")
            assert datagram[-1] != 0 or not strips
            assert [rig.verdict("hardware", datagram) for _ in range(2)] == ["accepted", "replayed"]
            assert restore(datagram)[: -(3 + 15)] == plain


def test_a_forwarded_datagram_has_the_signature_of_the_bridge_behind_that_of_its_sender(rig: SignedRig) -> None:
    """The receiver verifies the bridge's signature, and can verify the sender's; what is refused is not forwarded."""
    signer = rig.signer("hardware")
    rig.receive(datagram_of(SENSOR), changed_bit(signer.sign(datagram_of(SENSOR)), 3))
    assert not rig.account.forwarded
    sent = signer.sign(datagram_of(SENSOR))
    rig.receive(sent + bytes(5))
    forwarded = rig.next("basestation")
    assert forwarded[: len(sent)] == sent
    assert rig.verdict("basestation", forwarded) == "accepted"
    assert REGISTRY.envelope.FromString(forwarded).WhichOneof("payload") == "ph_info"


# --- clients ----------------------------------------------------------------------------------------------------


def test_a_client_with_the_key_file_signs_and_verifies(tmp_path: Path) -> None:
    """`key_files` is all that a program has to add."""
    registry = signing({"basestation": {"must_sign": True}})
    with SignedRig(tmp_path, registry) as rig:
        options: dict[str, Any] = {"registry": registry, "port": rig.bridge.port, "local_port": 0}
        with BlockingPeer.open("basestation", key_files=[tmp_path / "basestation.keys"], **options) as peer:
            rig.live.change({"dst_a_port": peer.port})
            peer.send(payload_at(COMMAND.payload_type, 1.0))
            wait_until(lambda: rig.account.published == {"control_mode": 1}, "the command")
            rig.receive(datagram_of(SENSOR))
            assert peer.receive(SENSOR.payload_type, PATIENCE_S) == payload_at(SENSOR.payload_type, 1.0)
            rig.board.sendto(datagram_of(SENSOR), ("127.0.0.1", peer.port))
            wait_until(lambda: not peer.arrived() and peer.traffic.dropped == {"unsigned": 1}, "the stranger's")


@pytest.mark.parametrize(
    ("opened", "error"),
    [
        (
            lambda _: Rig(signing({"basestation": {"must_sign": True}})),
            r"datagrams of .*'basestation' must be signed .*roverlink link keygen basestation",
        ),
        (lambda folder: open_links(REGISTRY, [folder / "x.keys"], LOGGER), "the table has no `signing`"),
        (
            lambda _: BlockingPeer.open("basestation", registry=signing()),
            r"'basestation' must sign .* no key file is given",
        ),
        (
            lambda folder: BlockingPeer.open(
                "hardware", board="ArmBoard", registry=signing(), key_files=_key_files(folder, "DrivingBoard")
            ),
            "no key with which ArmBoard of hardware signs",
        ),
    ],
    ids=["bridge without keys", "keys without signing", "client without keys", "key of another board"],
)
def test_keys_that_do_not_fit_are_an_error_at_the_start(
    tmp_path: Path, opened: Callable[[Path], object], error: str
) -> None:
    """The error names the end and the command that makes its keys; nothing has been sent by then."""
    with pytest.raises(SetupError, match=error):
        opened(tmp_path)


def test_boards_at_one_address_need_a_key_of_their_peer_for_link_messages(tmp_path: Path) -> None:
    """Each board has a key, but the bridge's link messages go to all of them: unsigned ones would be sent."""
    registry = signing({"hardware": {"must_sign": True}}, linked_registry())
    links = open_links(registry, _key_files(tmp_path, "Arm", "Drive"), LOGGER)
    with pytest.raises(SetupError, match=r"datagrams of 'hardware' must be signed .*roverlink link keygen hardware"):
        Rig(registry, links=links)


# --- attacks ----------------------------------------------------------------------------------------------------


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


@pytest.mark.slow
@pytest.mark.parametrize("count", [5_000, pytest.param(1_000_000, marks=pytest.mark.exhaustive)])
def test_forged_replayed_and_truncated_datagrams_are_counted_and_never_accepted(rig: SignedRig, count: int) -> None:
    """Over the socket: what is not an accepted datagram is a counted one, and each reason occurs."""
    stock = [rig.signer(handler.route.peer).sign(datagram_of(handler)) for handler in INBOUND for _ in range(5)]
    rig.receive(*stock)
    assert rig.account.published.total() == len(stock)
    rig.receive(*_hostile(stock, count))
    assert rig.account.published.total() == len(stock)
    assert rig.account.dropped.total() == count
    reasons = {"unsigned", "malformed_signature", "wrong_signature", "unknown_key", "replayed", "outdated"}
    assert reasons <= rig.dropped().keys()


# --- thieves ----------------------------------------------------------------------------------------------------

_DRIVE, _BASE = EndName("hardware", "Drive"), EndName("base")
_BOTH = {"hardware": {"must_sign": True}, "base": {"must_sign": True}}
_YEARS_9_9 = int(9.9 * 365 * 24 * 3600) * TICKS_PER_SECOND


def _with_boards(host: str, port: int) -> dict[str, dict[str, Any]]:
    boards = tuple(End(name, **end(name, host, port)) for name in ("Arm", "Drive"))
    return {**_BOTH, "hardware": {"must_sign": True, "port_parameter": "", "boards": boards}}


_TABLES: dict[str, tuple[EndName, dict[str, dict[str, Any]], str, str]] = {
    "mixed signing": (_BASE, {"base": {"must_sign": True}}, "dst_a_port", "refuse"),
    "boards": (_DRIVE, _with_boards("127.0.0.1", 9), "Drive_port", "warn"),
    "learn": (_DRIVE, _with_boards("learn", 0), "", "warn"),
    "link": (_DRIVE, _BOTH, "dst_b_port", "warn"),
    "refuse": (_DRIVE, _BOTH, "dst_b_port", "refuse"),
}
"""Tables, each with the end that is attacked, what its peers say, the end's port parameter, and the link policy."""


class _Attacked:
    """The rig of a table, the end that is attacked, and what a thief sends."""

    def __init__(self, folder: Path, table: str) -> None:
        self.end, peers, port, policy = _TABLES[table]
        self.name, self.folder, self.sock = self.end.board or self.end.peer, folder, listener()
        given = {port: port_of(self.sock)} if port else {}
        registry = signing(peers, linked_registry())
        self.rig = SignedRig(folder, registry, ["Arm", "Drive"], link_policy=policy, **given)
        self.own, self.command = ([4, 5], "map") if self.end == _BASE else ([2, 3], "drive_command")
        self.row = registry.by_number[self.own[0]].route.name
        assert registry.link is not None
        self.session = new_session()
        hashes = {number: registry.link.hashes[number] for number in self.own}
        self.writer = LinkWriter(registry.envelope, self.session, hashes)

    def speaks(self) -> list[bytes]:
        """Let the end itself send a payload and a link message, and return them."""
        self.writer.count_sent(1)
        plain = (self.payload(self.row), self.writer.write(1))
        signed = [self.rig.signer(self.name).sign(one) for one in plain]
        self.rig.receive(*signed, via=self.sock)
        return signed

    def payload(self, row: str) -> bytes:
        """An envelope with an empty payload."""
        return self.rig.registry.envelope(**{row: {}}).SerializeToString()

    def lies(self) -> list[bytes]:
        """What somebody sends who wants to be the end: its rows, and link messages with its and other sessions."""
        rows: tuple[list[int], ...] = (self.own, [*self.own, 1], [1], [])
        sessions = (self.session, *(new_session() for _ in range(10)))
        payloads = [self.payload(row) for row in (self.row, self.command) for _ in range(3)]
        envelope = self.rig.registry.envelope
        writers = (LinkWriter(envelope, session, dict.fromkeys(some, 7)) for session in sessions for some in rows)
        return [*payloads, *(writer.write(1) for writer in writers)]

    def state(self) -> tuple[object, dict[str, float], EndReport]:
        """What the bridge knows about the end."""
        (report,) = (report for report in self.rig.bridge.link_reports() if report.end == self.end)
        address = self.rig.bridge.link_states().get(self.end)
        return address, {**report.measured(), "age": 0}, dataclasses.replace(report, age=None)

    def thief_of_arm(self, ahead: int = 0) -> Callable[[bytes], bytes]:
        """Who signs with the key of the other board, by a clock that is ahead."""
        key = read_keys(self.folder / "Arm.keys")[0].key
        return Signer(NUMBER, key, SigningClock(SigningClock().last + ahead)).sign


_THIEVES: dict[str, Callable[[_Attacked, list[bytes]], list[bytes]]] = {
    "stranger": lambda at, _: [
        forged
        for lie in at.lies()
        for forged in (lie, *(Signer(NUMBER, Key(id, "x", bytes(32)), SigningClock()).sign(lie) for id in (1, 5, 99)))
    ],
    "key of a board": lambda at, _: [*map(at.thief_of_arm(), at.lies())],
    "old datagrams": lambda _, heard: heard * 3,
    "wrong clock": lambda at, _: [
        signed for years in (1, 2, 3) for signed in map(at.thief_of_arm(years * _YEARS_9_9), at.lies())
    ],
}


@pytest.mark.parametrize("table", _TABLES)
@pytest.mark.parametrize("thief", _THIEVES)
def test_no_thief_changes_the_state_of_another_end(tmp_path: Path, thief: str, table: str) -> None:
    """Nothing is published, learned, refused or measured in the name of an end that signs, and it goes on as before."""
    at = _Attacked(tmp_path, table)
    with at.sock, at.rig as rig:
        heard = at.speaks()
        before = at.state()
        at.writer.count_sent(3)  # they are lost; what the thief sends must not make up for them
        rig.receive(*_THIEVES[thief](at, heard))
        assert at.state() == before
        assert str(at.end) not in rig.account.other_schemas
        at.speaks()
        _, measured, report = at.state()
        assert (rig.account.published[at.row], measured["lost_in"], report.senders) == (2, 3, 1)
        rig.publish(at.command)
        while at.command != rig.registry.envelope.FromString(datagram := at.sock.recv(65_536)).WhichOneof("payload"):
            pass
        assert rig.verdict(at.name, datagram) == "accepted"
        assert (rig.account.dropped["ahead"] > 0) is (thief == "wrong clock") is ("Arm" in rig.account.clocks_ahead)
