"""Frames that arrive in parts: lost, late, doubled and in another order, from a sender that may start again."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from generated.pb2.components.basestation.detected_object_pb2 import BasestationDetectedObject
from roverlink.runtime.client import Frame, Reassembler

_PERIOD_S = 0.1


@dataclass(frozen=True)
class _Part:
    frame_id: int
    index: int
    total_count: int
    run: int = 0


def _parts(frame_id: int, count: int, run: int = 0) -> list[_Part]:
    """What a sender sends for a frame; a frame without objects is one part as well."""
    return [_Part(frame_id, index, count, run) for index in range(max(count, 1))]


def _added(reassembler: Reassembler[_Part], arrivals: list[tuple[float, _Part]]) -> list[Frame[_Part]]:
    frames = (reassembler.add(part, at) for at, part in arrivals)
    return [frame for frame in frames if frame is not None]


def test_the_parts_of_a_frame_come_out_in_the_order_of_their_index() -> None:
    """Whatever the order in which they came; as payloads of the table, with this computer's clock."""
    reassembler = Reassembler[BasestationDetectedObject]()
    objects = [BasestationDetectedObject(frame_id=7, total_count=3, index=index, id=index) for index in range(3)]
    assert reassembler.add(objects[2]) is None
    assert reassembler.add(objects[0]) is None
    assert reassembler.add(objects[1]) == Frame(7, tuple(objects))
    assert reassembler.add(BasestationDetectedObject(frame_id=8)) == Frame(8, ())  # one that saw nothing


def test_a_number_that_was_damaged_on_the_way_blocks_nothing_for_long() -> None:
    """A frame of the far future hides the present for a second only."""
    reassembler = Reassembler[_Part]()
    future = (0.0, _Part(2**32 - 1, 0, 1))
    present = [(number * _PERIOD_S, *_parts(number, 1)) for number in range(1, 20)]
    frames = _added(reassembler, [future, *present])
    assert [frame.frame_id for frame in frames] == [2**32 - 1, *range(10, 20)]
    assert reassembler.restarts == 1


def test_few_frames_wait() -> None:
    """Of many frames that lack a part, the oldest are given up: nonsense fills no memory."""
    reassembler = Reassembler[_Part]()
    frames = [_parts(number, 2) for number in range(1, 101)]
    assert _added(reassembler, [(0.0, first) for first, _ in frames]) == []
    assert reassembler.lost == 100 - 16
    came = _added(reassembler, [(0.0, last) for _, last in frames[-16:]])
    assert [frame.frame_id for frame in came] == [*range(85, 101)]


# --- C++ ----------------------------------------------------------------------------------------------------------

_CASES = Path(__file__).parents[2] / "cpp/tests/reassembly_cases.tsv"
_COUNTS = ("complete", "lost", "late", "duplicates", "invalid", "restarts")


def _random_arrivals(rng: random.Random) -> list[tuple[int, _Part]]:
    """Times in milliseconds and parts of a sender on a bad network, which starts again now and then."""
    arrivals: list[tuple[int, _Part]] = []
    now = frame_id = 0
    for _ in range(60):
        if rng.random() < 0.05:
            frame_id, now = 0, now + rng.choice([300, 1500])
        for part in _parts(frame_id, rng.choice([0, 1, 2, 3, 5])):
            if rng.random() < 0.15:
                part = replace(part, total_count=rng.randrange(5), frame_id=rng.choice([frame_id, 7, 2**32 - 1]))
            for _ in range(rng.choice([0, 1, 1, 1, 1, 2])):
                arrivals.append((now + rng.choice([0, 5, 40, 250, 1100]), part))
        frame_id, now = frame_id + rng.choice([1, 1, 1, 2]), now + 50
    return sorted(arrivals, key=lambda one: one[0])


def _case(rng: random.Random) -> Iterator[str]:
    timeout = rng.choice([100, 1000])
    reassembler = Reassembler[_Part](timeout)  # milliseconds are exact numbers, other than their fractions of a second
    yield f"reset\t{timeout}"
    for at, part in _random_arrivals(rng):
        frame = reassembler.add(part, at)
        out = "-" if frame is None else f"{frame.frame_id}:{len(frame.parts)}"
        yield f"part\t{at}\t{part.frame_id}\t{part.index}\t{part.total_count}\t{out}"
    yield "\t".join(["counts", *(str(getattr(reassembler, name)) for name in _COUNTS)])


def test_the_cases_for_cpp_are_what_python_does(request: pytest.FixtureRequest) -> None:
    """The tests of the C++ library read them from a file, which `--update-cases` writes anew."""
    head = (
        "# Arrivals of parts, and what comes out: Python and C++ must agree with every line. Columns are separated by\n"
        "# tabs.\n#\n# reset\ttimeout in milliseconds\n"
        "# part\tmilliseconds\tframe_id\tindex\ttotal_count\tframe:parts, or -\n"
        "# counts\t" + "\t".join(_COUNTS) + "\n"
    )
    lines = [line for seed in range(12) for line in _case(random.Random(seed))]  # noqa: S311  # no secrets
    text = head + "".join(f"{line}\n" for line in lines)
    if request.config.getoption("--update-cases"):
        _CASES.write_text(text, encoding="utf-8")
    assert text == _CASES.read_text(encoding="utf-8")
