"""RTP, RTCP and H.264's NAL units: what is sent arrives, and what is missing or damaged is told."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverkit.video import h264, rtcp, rtp
from roverkit.video.reordering import WAIT_NS, Reordering

_WORD, _SHORT = st.integers(0, 2**32 - 1), st.integers(0, 2**16 - 1)
_NALS = st.lists(
    st.builds(lambda kind, body: bytes([0x60 | kind]) + body + b"\x01", st.integers(1, 23), st.binary(max_size=300)),
    min_size=1,
    max_size=8,
)
_PACKETS = st.builds(rtp.RtpPacket, _SHORT, _WORD, _WORD, st.booleans(), st.binary(min_size=1), st.integers(0, 127))


@given(_PACKETS, st.integers(0, 15), st.integers(0, 3), st.integers(1, 5))
def test_a_packet_is_read_as_it_was_written(packet: rtp.RtpPacket, sources: int, words: int, padding: int) -> None:
    """All fields, and the payload, also between sources, an extension and padding (RFC 3550, section 5.1)."""
    data = packet.encode()
    assert rtp.read_packet(data) == packet
    parts = [bytes([data[0] | 0x30 | sources]), data[1:12], bytes(4 * sources), bytes([0, 0, 0, words])]
    assert rtp.read_packet(b"".join([*parts, bytes(4 * words), data[12:], bytes([padding] * padding)])) == packet


@given(st.binary(max_size=100))
def test_any_bytes_can_be_read(data: bytes) -> None:
    """A port is open to everybody."""
    list(rtcp.read_reports(data))
    h264.stamp_of([data])
    if (packet := rtp.read_packet(data)) is not None:
        list(rtp.Depacketizer().add(packet, 0))


@pytest.mark.slow
@given(_NALS, st.integers(20, 400))
def test_an_access_unit_arrives_as_it_was_sent(nals: list[bytes], largest: int) -> None:
    """However its NAL units are grouped or divided, and no packet is too long."""
    parts = rtp.payloads(nals, largest)
    assert max(map(len, parts)) <= largest
    depacketizer = rtp.Depacketizer()
    packets = [rtp.RtpPacket(index, 3000, 1, index == len(parts) - 1, part) for index, part in enumerate(parts)]
    assert [one for packet in packets for one in depacketizer.add(packet, 0)] == [rtp.AccessUnit(nals, 3000, True)]


@pytest.mark.slow
@given(_NALS, st.integers(20, 100), st.data())
def test_a_unit_with_a_missing_packet_is_not_complete(nals: list[bytes], largest: int, data: st.DataObject) -> None:
    """Its NAL units are those that were sent, without those to which the packet belongs; the next unit is unhurt."""
    parts = rtp.payloads(nals, largest)
    lost = data.draw(st.integers(0, len(parts) - 1))
    units, depacketizer = [], rtp.Depacketizer()
    for index, part in enumerate([*parts, b"\x41next", b"\x41last"]):
        timestamp = 3000 * (1 + max(index - len(parts) + 1, 0))
        packet = rtp.RtpPacket(index, timestamp, 1, index >= len(parts) - 1, part)
        if index != lost:
            units += depacketizer.add(packet, int(index == lost + 1))
    assert units[-1] == rtp.AccessUnit([b"\x41last"], 9000, True)
    assert not all(unit.complete for unit in units) or len(units) == 2  # a unit of which nothing is left does not come
    assert all(nal in [*nals, b"\x41next", b"\x41last"] for unit in units for nal in unit.nals)


@given(_NALS)
def test_a_byte_stream_is_divided_into_its_nal_units(nals: list[bytes]) -> None:
    """Start codes have three or four bytes; NAL units never contain one."""
    clean = [nal.replace(b"\x00\x00", b"\x00\x07") for nal in nals]
    assert h264.nal_units(h264.byte_stream(clean)) == clean
    assert h264.nal_units(b"".join(b"\x00\x00\x01" + nal for nal in clean)) == clean


@given(st.integers(0, 2**64 - 1))
def test_the_time_of_an_image_arrives(stamp: int) -> None:
    """Any time, also one with bytes that look like a start code; it is before the slices."""
    nals = h264.with_stamp([b"\x67sps", b"\x65slice"], stamp)
    assert h264.stamp_of(nals) == stamp
    assert [h264.nal_type(nal) for nal in nals] == [h264.NalType.SPS, h264.NalType.SEI, h264.NalType.KEY_SLICE]
    assert h264.nal_units(h264.byte_stream(nals)) == nals
    assert h264.stamp_of([b"\x65slice"]) is None


_LOST = st.integers(-(2**23) + 1, 2**23 - 1)
_REPORTS = st.tuples(
    st.builds(rtcp.SenderReport, _WORD, st.integers(0, 2**64 - 1), _WORD, _WORD, _WORD),
    st.builds(rtcp.ReceiverReport, _WORD, _WORD, st.integers(0, 255).map(lambda part: part / 256), _LOST, *[_WORD] * 4),
    st.builds(rtcp.PictureLoss, _WORD, _WORD),
)


@given(_REPORTS)
def test_reports_are_read_as_they_were_written(reports: tuple) -> None:
    """Reports of senders and receivers, and requests for key frames, also in one datagram; packets are no reports."""
    data = b"".join(report.encode() for report in reports)
    assert rtcp.is_rtcp(data)
    assert tuple(rtcp.read_reports(data)) == reports
    assert not any(rtcp.is_rtcp(rtp.RtpPacket(1, 2, 3, marker, b"x" * 8).encode()) for marker in (False, True))


def _packet(number: int) -> rtp.RtpPacket:
    return rtp.RtpPacket(number & 0xFFFF, 0, 1, False, b"x")


@given(st.permutations(range(12)), st.integers(0, 2**16 - 1), st.sets(st.integers(0, 11)))
def test_packets_leave_in_their_order(order: list[int], first: int, twice: set[int]) -> None:
    """Whatever the order of their arrival, and if some come twice; nothing counts as lost."""
    reordering, out = Reordering(), []
    start = _packet(first - 1)
    out += reordering.add(start, 0)
    for number in order:
        for _ in range(1 + (number in twice)):
            out += reordering.add(_packet(first + number), 0)
    assert out == [(start, 0), *((_packet(first + number), 0) for number in range(12))]
    assert reordering.arrivals.received == 13
    assert reordering.arrivals.lost == 0


def test_a_missing_packet_is_waited_for_and_requested() -> None:
    """Every 15 ms, and at most for 50 ms; then the packets after it leave, and it is lost."""
    reordering = Reordering()
    list(reordering.add(_packet(65_534), 0))
    assert list(reordering.add(_packet(1), 0)) == []
    assert reordering.wanted(0) == [65_535, 0]
    assert reordering.wanted(1_000_000) == []
    assert list(reordering.add(_packet(0), 2_000_000)) == []
    assert reordering.arrivals.repaired == 1
    assert reordering.next_due() == 15_000_000
    requests = [bool(reordering.wanted(now)) for now in (14_000_000, 15_000_000, 20_000_000, 31_000_000, 46_000_000)]
    assert requests == [False, True, False, True, True]
    assert reordering.next_due() == WAIT_NS
    assert list(reordering.due(WAIT_NS - 1)) == []
    assert list(reordering.due(WAIT_NS)) == [(_packet(0), 1), (_packet(1), 0)]
    assert reordering.arrivals.lost == 1
    assert list(reordering.add(_packet(65_535), WAIT_NS)) == []


def test_a_long_gap_is_not_requested() -> None:
    """A key frame costs less than so many packets. Another run of the sender begins anew: its numbers jump."""
    reordering = Reordering()
    for number in (0, 66):
        list(reordering.add(_packet(number), 0))
    assert reordering.wanted(0) == []
    assert reordering.next_due() == WAIT_NS
    assert list(reordering.due(WAIT_NS)) == [(_packet(66), 65)]
    assert reordering.next_due() is None
    for packet in (_packet(5000), _packet(20_000), rtp.RtpPacket(7, 0, 2, False, b"x")):
        assert list(reordering.add(packet, 0)) == [(packet, 0)]
    assert reordering.arrivals.received == 1
