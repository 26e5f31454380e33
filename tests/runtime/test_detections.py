"""Frames of detected objects: split into messages, and put together again whatever the network does to them."""

from __future__ import annotations

import random
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from generated.messages import BasestationDetectedObject, BoundingBox
from generated.pb2.components.basestation import detected_object_pb2
from runtime.detections import Assembler, Frame, Limits, split

_LIMITS = Limits(timeout_s=0.2, remembered_s=1.0)
Object = BasestationDetectedObject
Frames = list[Frame[BasestationDetectedObject]]


def _objects(frame_id: int, count: int, run: int = 0) -> list[Object]:
    """A frame's messages; their content is like that of no other."""
    objects = [
        Object(id=run * 1000 + frame_id * 10 + n, bbox=BoundingBox(x=n, y=run, width=4, height=5)) for n in range(count)
    ]
    return split(frame_id, objects, Object)


def _assembled(arrivals: Iterable[tuple[float, Object]], assembler: Assembler[Object] | None = None) -> Frames:
    """All frames that come of messages with their times, once everybody's time is up."""
    assembler = assembler or Assembler(_LIMITS)
    frames: Frames = []
    for now, message in arrivals:
        frames += assembler.add(message, now)
    return frames + assembler.expire(1e9)


def test_a_frame_becomes_one_message_an_object() -> None:
    """Each says which frame it is of, how many there are, and which it is."""
    assert [(m.frame_id, m.total_count, m.index) for m in _objects(7, 3)] == [(7, 3, 0), (7, 3, 1), (7, 3, 2)]


def test_an_empty_frame_says_that_it_is_empty() -> None:
    """One message with a total of 0, which the other end takes for a whole frame."""
    messages = _objects(7, 0)
    assert [(m.frame_id, m.total_count, m.index) for m in messages] == [(7, 0, 0)]
    assert _assembled([(0.0, messages[0])]) == [Frame(7, 0, (), ())]


def test_protobuf_payloads_are_split_and_assembled_as_ros_messages_are() -> None:
    """The basestation works with payloads, a ROS 2 node with messages."""
    payload = detected_object_pb2.BasestationDetectedObject
    messages = split(3, [payload(id=1), payload(id=2)], payload)
    assembler: Assembler[detected_object_pb2.BasestationDetectedObject] = Assembler()
    assert assembler.add(messages[1], 0.0) == []
    (frame,) = assembler.add(messages[0], 0.01)
    assert [o.id for o in frame.objects] == [1, 2]


def test_a_frame_with_a_loss_is_delivered_once_its_time_is_up() -> None:
    """With what arrived, and which are missing."""
    first, _, third = _objects(1, 3)
    assembler: Assembler[Object] = Assembler(_LIMITS)
    assert assembler.add(first, 10.0) == assembler.add(third, 10.1) == []
    assert assembler.next_deadline == pytest.approx(10.2)
    assert assembler.expire(10.19) == []
    assert assembler.expire(10.2) == [Frame(1, 3, (first, third), (1,))]
    assert assembler.next_deadline is None
    assert (assembler.counts.complete, assembler.counts.partial) == (0, 1)


def test_what_comes_after_its_frame_is_counted_and_delivers_nothing() -> None:
    """Neither the straggler nor its duplicate makes a second frame 1."""
    first, second = _objects(1, 2)
    assembler: Assembler[Object] = Assembler(_LIMITS)
    frames = _assembled([(0.0, first), (0.5, second), (0.6, second), (0.7, first)], assembler)
    assert [frame.missing for frame in frames] == [(1,)]
    assert (assembler.counts.late, assembler.counts.duplicates) == (1, 2)


@pytest.mark.parametrize("gap", [0.01, 5.0])
def test_a_sender_that_starts_anew_at_frame_0_is_heard_at_once(gap: float) -> None:
    """A new run has the ids of the old one; other objects, or a pause, tell them apart."""
    arrivals = [(0.001 * n, m) for n, m in enumerate([*_objects(0, 2), *_objects(1, 2)])]
    arrivals += [(gap + 0.001 * n, m) for n, m in enumerate([*_objects(0, 2, run=1), *_objects(1, 3, run=1)])]
    frames = _assembled(arrivals)
    assert [(frame.frame_id, len(frame.objects), frame.missing) for frame in frames] == [
        (0, 2, ()),
        (1, 2, ()),
        (0, 2, ()),
        (1, 3, ()),
    ]


def test_a_new_run_cuts_an_open_frame_of_the_old_one_short() -> None:
    """Objects of two runs never meet in one frame."""
    old, new = _objects(0, 3), _objects(0, 2, run=1)
    frames = _assembled([(0.0, old[0]), (0.01, new[0]), (0.02, new[1])])
    assert frames == [Frame(0, 3, (old[0],), (1, 2)), Frame(0, 2, tuple(new), ())]


def test_a_new_run_of_empty_frames_is_heard_after_a_while() -> None:
    """An empty frame 0 looks like any other; only the time tells it from a duplicate."""
    empty = _objects(0, 0)[0]
    assert len(_assembled([(0.0, empty), (0.5, empty), (1.0, empty)])) == 2


@pytest.mark.parametrize(("total", "index"), [(257, 0), (3, 3), (0, 1), (2**32 - 1, 5)])
def test_a_message_that_cannot_be_is_refused(total: int, index: int) -> None:
    """No claim makes the assembler hold, or list as missing, more than it may."""
    assembler: Assembler[Object] = Assembler(_LIMITS)
    assert _assembled([(0.0, Object(frame_id=1, total_count=total, index=index))], assembler) == []
    assert assembler.counts.refused == 1


@given(
    st.lists(st.integers(0, 6), min_size=1, max_size=8),
    st.randoms(use_true_random=False),
    st.floats(0, 0.7),
    st.floats(0, 0.7),
)
def test_loss_duplication_and_reordering_lose_no_more_than_what_was_lost(
    counts: list[int], rng: random.Random, loss: float, duplication: float
) -> None:
    """Every frame of which something arrived is delivered once, with just the lost ones missing."""
    frames = {frame_id: _objects(frame_id, count) for frame_id, count in enumerate(counts)}
    survivors = [message for messages in frames.values() for message in messages if rng.random() >= loss]
    arriving = survivors + [message for message in survivors if rng.random() < duplication]
    rng.shuffle(arriving)
    delivered = _assembled((0.1 * n / len(arriving), message) for n, message in enumerate(arriving))
    assert len({frame.frame_id for frame in delivered}) == len(delivered)
    assert {frame.frame_id for frame in delivered} == {message.frame_id for message in survivors}
    for frame in delivered:
        arrived = [message for message in survivors if message.frame_id == frame.frame_id]
        sent = counts[frame.frame_id]
        assert frame.total_count == sent
        assert list(frame.objects) == (arrived if sent else [])
        assert set(frame.missing) == set(range(sent)) - {message.index for message in arrived}


@given(
    st.lists(
        st.tuples(
            st.floats(0, 0.5),
            st.integers(0, 2**32 - 1),
            st.integers(0, 2**32 - 1) | st.integers(0, 5),
            st.integers(0, 9),
        ),
        max_size=200,
    )
)
def test_whatever_arrives_memory_is_bounded_and_the_sums_agree(arrivals: list[tuple[float, int, int, int]]) -> None:
    """Every message ends in a frame, or is counted as a duplicate, late or refused."""
    limits = Limits(timeout_s=0.2, remembered_s=1.0, open_frames=3, objects=5, remembered_frames=4)
    assembler: Assembler[Object] = Assembler(limits)
    now, delivered = 0.0, []
    for wait, frame_id, total, index in arrivals:
        now += wait
        delivered += assembler.add(Object(frame_id=frame_id % 12, total_count=total, index=index), now)
        assert len(assembler._open) <= 3
        assert len(assembler._delivered) <= 4
    delivered += assembler.expire(now + 1e6)
    in_frames = sum(len(frame.objects) if frame.total_count else 1 for frame in delivered)
    counts = assembler.counts
    assert in_frames + counts.duplicates + counts.late + counts.refused == len(arrivals)
    assert counts.complete + counts.partial == len(delivered)
