"""Key files, the stored timestamps, and what a restart does to a signed link."""

from __future__ import annotations

import logging
import stat
from datetime import datetime, timezone
from pathlib import Path

import pytest

from roverlink.runtime.core.errors import DatagramError, SetupError
from roverlink.runtime.core.signing import TICKS_PER_SECOND, Signer, SigningClock
from roverlink.runtime.keys.key_file import make_key_file, read_keys
from roverlink.runtime.keys.signed_links import SignedLinks

NUMBER = 23
MADE = datetime(2026, 11, 23, 7, 30, tzinfo=timezone.utc)
START = MADE.timestamp() + 3600
LOGGER = logging.getLogger("test_key_files")


class Computer:
    """A computer with its copy of the key file, which runs one program at a time."""

    def __init__(self, folder: Path, name: str, content: str, wall: float = START) -> None:
        self.name, self.wall, self.steady = name, wall, 50.0
        self.keys = folder / name / "link.keys"
        self.keys.parent.mkdir()
        self.keys.write_text(content)
        self.keys.chmod(0o600)

    def passes(self, seconds: float) -> None:
        """Let both clocks run."""
        self.wall, self.steady = self.wall + seconds, self.steady + seconds

    def links(self) -> SignedLinks:
        """Start the program."""
        clocks = (lambda: int(self.wall * 10**9)), (lambda: int(self.steady * 10**9))
        return SignedLinks(NUMBER, [self.keys], LOGGER, self.name, *clocks)

    def runs(self, links: SignedLinks) -> None:
        """Let the program store its timestamps and end."""
        with links:
            pass


def _signer(links: SignedLinks, end: str) -> Signer:
    signer = links.signer([end])
    assert signer is not None
    return signer


def _verdict(links: SignedLinks, datagram: bytes, sender: str) -> str:
    try:
        links.verifier.verify(datagram, {sender})
    except DatagramError as error:
        return error.reason.value
    return "accepted"


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    """A fresh key file of the basestation."""
    make_key_file(tmp_path / "basestation.keys", "basestation", MADE)
    return tmp_path / "basestation.keys"


@pytest.fixture
def rover(tmp_path: Path, key_file: Path) -> Computer:
    """The computer of the bridge."""
    return Computer(tmp_path, "ros", key_file.read_text())


@pytest.fixture
def basestation(tmp_path: Path, key_file: Path) -> Computer:
    """The computer of the basestation, with the same key file."""
    return Computer(tmp_path, "basestation", key_file.read_text())


def test_a_key_file_is_for_its_owner_and_is_never_overwritten(key_file: Path) -> None:
    """The mode is 0600; nobody else gets keys: the bridge has none of its own, and a name is no path."""
    assert stat.S_IMODE(key_file.stat().st_mode) == 0o600
    before = key_file.read_bytes()
    refused = "is not the name of a peer or board"
    for path, name, made, error in (
        (key_file, "basestation", MADE, "the file exists; to change its keys, add new ones with --rotate"),
        *((key_file.with_name("x"), name, MADE, refused) for name in ("ros", "../x", "a b", "")),
        # The time of its keys is the oldest that a datagram may have.
        (key_file.with_name("x"), "base", MADE.replace(year=1970), "clock of this computer says 1970-11-23; set it"),
    ):
        with pytest.raises(SetupError, match=error):
            make_key_file(path, name, made)
    assert [file.read_bytes() for file in key_file.parent.iterdir()] == [before]


def test_a_key_file_has_one_key_for_each_direction(key_file: Path) -> None:
    """Two senders never share a key, because their clocks differ; ids differ from those of others in the folder."""
    one, two = read_keys(key_file)
    assert (one.key.sender, one.receiver, two.key.sender, two.receiver) == ("basestation", "ros", "ros", "basestation")
    assert one.key.secret != two.key.secret
    others = make_key_file(key_file.with_name("ArmBoard.keys"), "ArmBoard", MADE)
    assert [key.key.id for key in (one, two, *others)] == [1, 2, 3, 4]


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o660])
def test_a_file_that_others_can_read_is_refused_with_the_command_that_helps(key_file: Path, mode: int) -> None:
    """A key that others have read is no key."""
    key_file.chmod(mode)
    with pytest.raises(SetupError, match=f"run: chmod 600 {key_file}"):
        read_keys(key_file)


@pytest.mark.parametrize(
    ("old", "new", "error"),
    [
        ("secret = ", "secret = zz", "`secret` must have 64 hexadecimal digits"),
        ("secret = ", "secret = 00", "`secret` must have 64 hexadecimal digits"),
        ("send_with = yes", "send_with = no", "write `send_with = yes` for exactly one of the key 1"),
        ("send_with = yes", "send_with = maybe", "`send_with` must be yes or no"),
        ("to = ros", "to = basestation", "either `from` or `to` must be ros, the bridge"),
        ("made = 2026-11-23T07:30:00Z", "made = yesterday", "`made` must be a time such as"),
        ("made = 2026-11-23T07:30:00Z\n", "", "`made` is missing"),
        ("to = ros", "to = ros\nport = 5", "there is an unknown option"),
        ("[key 1]", "[key 256]", r"a section must be \[key N\] with a number up to 255"),
        ("[key 1]", "", ":5: the line stands before the first section"),
        ("from = basestation", "from", "the line is not like `from = basestation`"),
        ("[key 2]", "[key 1]", "occurs twice"),
    ],
)
def test_mistakes_in_a_key_file_are_named_without_its_secrets(key_file: Path, old: str, new: str, error: str) -> None:
    """The error has file and place, and no part of a secret, not even in the chain of exceptions."""
    text = key_file.read_text()
    secrets = [line.partition(" = ")[2] for line in text.splitlines() if line.startswith("secret")]
    key_file.write_text(text.replace(old, new, 1))
    with pytest.raises(SetupError, match=error) as refused:
        read_keys(key_file)
    shown: BaseException | None = refused.value
    assert str(key_file) in str(shown)
    while shown is not None:
        assert all(secret[:8] not in str(shown) for secret in secrets)
        shown = shown.__cause__


def test_a_restart_accepts_no_recording(rover: Computer, basestation: Computer) -> None:
    """Whatever the rover's clock says after the restart: what was accepted before is old."""
    signer, links = _signer(basestation.links(), "ros"), rover.links()
    recording = []
    for _ in range(20):
        recording.append(signer.sign(b"\x6a\0"))
        assert _verdict(links, recording[-1], "basestation") == "accepted"
        basestation.passes(0.1)
        rover.passes(0.1)
    rover.runs(links)
    for wall in (0, START - 86_400, rover.wall, START + 86_400):
        rover.wall, rover.steady = wall, 3
        links = rover.links()
        assert {_verdict(links, datagram, "basestation") for datagram in recording} == {"outdated"}


def test_a_restart_without_a_clock_locks_nobody_out(rover: Computer, basestation: Computer) -> None:
    """Both computers lose their power and start in 1970: after a second, each accepts the other again."""
    for _ in range(3):
        ends = {"ros": (rover, rover.links()), "basestation": (basestation, basestation.links())}
        for computer, _links in ends.values():
            computer.passes(1.01)
        for name, other in (("ros", "basestation"), ("basestation", "ros")):
            for _ in range(50):
                datagram = _signer(ends[name][1], other).sign(b"\x6a\0")
                assert _verdict(ends[other][1], datagram, name) == "accepted"
                rover.passes(0.02)
                basestation.passes(0.02)
        for computer, links in ends.values():
            computer.runs(links)
            computer.wall, computer.steady = 0, 2


def test_a_crash_loses_at_most_the_second_that_a_restart_adds(rover: Computer, basestation: Computer) -> None:
    """The timestamps on the disk are up to a second old: what was accepted after them stays refused."""
    signer, links = _signer(basestation.links(), "ros"), rover.links()
    assert _verdict(links, signer.sign(b"\x6a\0"), "basestation") == "accepted"
    rover.runs(links)
    links = rover.links()
    basestation.passes(1.5)
    assert _verdict(links, signer.sign(b"\x6a\0"), "basestation") == "accepted"
    rover.runs(links)  # which stores them, as the thread does each second
    basestation.passes(0.9)
    lost = signer.sign(b"\x6a\0")
    assert _verdict(links, lost, "basestation") == "accepted"
    rover.wall = 0
    after = rover.links()
    assert _verdict(after, lost, "basestation") == "outdated"
    basestation.passes(0.2)
    assert _verdict(after, signer.sign(b"\x6a\0"), "basestation") == "accepted"


@pytest.mark.parametrize("content", [None, "", "noise", "# header\n1 5\n", "# header\n1 x\nend\n", "\xff"])
def test_without_stored_timestamps_only_the_last_minute_is_accepted(
    rover: Computer, basestation: Computer, content: str | None, caplog: pytest.LogCaptureFixture
) -> None:
    """A lost or damaged file does not open the link to all recordings, and a damaged one is reported."""
    stored = rover.keys.with_name("link.keys.ros.timestamps")
    rover.runs(rover.links())
    stored.unlink() if content is None else stored.write_bytes(content.encode("latin-1"))
    signer = _signer(basestation.links(), "ros")
    old, fresh = signer.sign(b"\x6a\0"), None
    rover.passes(61)
    links = rover.links()
    basestation.passes(30)
    fresh = signer.sign(b"\x6a\0")
    assert [_verdict(links, datagram, "basestation") for datagram in (old, fresh)] == ["outdated", "accepted"]
    assert ("is damaged" in caplog.text) is (content is not None)


def test_a_key_sets_the_clock_of_its_own_link_alone_and_only_so_far(
    rover: Computer, basestation: Computer, caplog: pytest.LogCaptureFixture
) -> None:
    """Whoever has the key of a board cannot make the others refuse the bridge, and the log says what happened."""
    board_keys = rover.keys.with_name("Arm.keys")
    key = make_key_file(board_keys, "Arm", MADE)[0].key
    clocks = (lambda: int(rover.wall * 10**9)), (lambda: int(rover.steady * 10**9))
    other = basestation.links()
    now, nearly_ten_years = other.clocks["basestation"].last, int(9.9 * 365 * 24 * 3600) * TICKS_PER_SECOND
    for start in range(2):
        links = SignedLinks(NUMBER, [rover.keys, board_keys], LOGGER, "ros", *clocks)
        times = (now + n * nearly_ten_years for n in (1, 2, 3))
        thief = (Signer(NUMBER, key, SigningClock(time)).sign(b"\x6a\0") for time in times)
        verdicts = ["outdated" if start else "accepted", "ahead", "ahead"]
        assert [_verdict(links, datagram, "Arm") for datagram in thief] == verdicts
        assert links.verifier.ahead == ({} if start else {"Arm": 1})
        rover.runs(links)
        basestation.passes(2)
        rover.passes(2)
        assert _verdict(other, _signer(links, "basestation").sign(b"\x6a\0"), "ros") == "accepted"
        assert caplog.text.count("the timestamps of the link with 'Arm' are 3613 days") == start + 1
    assert "link with 'basestation'" not in caplog.text


def test_a_folder_that_cannot_be_written_is_an_error_at_the_start(rover: Computer) -> None:
    """Without stored timestamps, a restart would accept recordings."""
    (rover.keys.with_name("link.keys.ros.timestamps")).mkdir()
    with pytest.raises(SetupError, match="cannot write the file"):
        rover.links()


def test_keys_of_others_are_an_error(rover: Computer, basestation: Computer) -> None:
    """Two files with one id, which says how to make another; and a key of an unknown end, which would not be used."""
    with pytest.raises(SetupError, match="both have a key 1; make one of them again in the folder of the other"):
        SignedLinks(NUMBER, [rover.keys, basestation.keys], LOGGER)
    with pytest.raises(SetupError, match=r"the key 1 is of 'basestation'.*did you mean 'base_station'"):
        rover.links().check_ends(["hardware", "base_station"])
