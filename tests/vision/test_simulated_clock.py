"""The time of a simulation, and what is stamped with it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from polling import PATIENCE_S, wait_until

from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import builtin_interfaces
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.interfaces.sensor_msgs import Image
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_time import simulated_clock
from roverlink.runtime.ros_time.simulated_clock import SimulatedClock
from roverlink.vision.frames import Frame, TopicSource, open_source, play
from tests.vision.ros_images import image

Tick = Callable[[float], object]


@pytest.fixture
def graph() -> Graph:
    return Graph()


@pytest.fixture
def tick(graph: Graph) -> Tick:
    """Publishes a time in seconds on /clock."""
    publisher = MemoryMiddleware(graph).publisher("/clock", Clock, Qos())

    def tick(seconds: float) -> None:
        ns = round(seconds * 1e9)
        publisher.publish([cdr.encode(Clock(builtin_interfaces.Time(ns // 10**9, ns % 10**9)))])

    return tick


@pytest.fixture
def clock(graph: Graph, tick: Tick) -> SimulatedClock:
    """A clock that shows 10 s."""
    clocks: list[SimulatedClock] = []
    thread = threading.Thread(target=lambda: clocks.append(SimulatedClock(MemoryMiddleware(graph), "/clock", print)))
    thread.start()
    wait_until(lambda: graph.callbacks["/clock"], "the subscription")
    tick(10)
    thread.join(PATIENCE_S)
    return clocks[0]


def test_it_shows_the_newest_time(clock: SimulatedClock, tick: Tick) -> None:
    """Forwards and backwards; damaged messages change nothing."""
    assert clock.now() == 10_000_000_000
    tick(12.5)
    assert clock.now() == 12_500_000_000
    tick(1)
    assert clock.now() == 1_000_000_000


def test_a_missing_simulation_is_told(graph: Graph, tick: Tick, monkeypatch: pytest.MonkeyPatch) -> None:
    """The program waits for the first time, and says for what."""
    monkeypatch.setattr(simulated_clock, "PATIENCE_S", 0.05)
    said: list[str] = []
    thread = threading.Thread(target=SimulatedClock, args=(MemoryMiddleware(graph), "/clock", said.append))
    thread.start()
    wait_until(lambda: said, "the message")
    assert said == ["waiting for the time of the simulation: use_sim_time is set, but nothing comes on /clock"]
    tick(1)
    thread.join(PATIENCE_S)
    assert not thread.is_alive()


def _played(folder: Path, clock: SimulatedClock, frames: int) -> tuple[list[Frame], threading.Thread]:
    for number in range(frames):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((8, 8), number, np.uint8))
    shown: list[Frame] = []

    def run() -> None:
        with open_source(str(folder)) as source:  # 30 Hz
            for frame in play(source, clock=clock):
                shown.append(frame)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return shown, thread


def test_a_recording_is_played_in_the_time_of_the_simulation(clock: SimulatedClock, tick: Tick, tmp_path: Path) -> None:
    """A frame comes when the simulation has reached its time, and not when the wall clock has."""
    shown, thread = _played(tmp_path, clock, 3)
    wait_until(lambda: len(shown) == 1, "the first frame")
    tick(10.02)
    assert len(shown) == 1
    tick(10.04)
    wait_until(lambda: len(shown) == 2, "the second frame")
    tick(11)
    thread.join(PATIENCE_S)
    assert [round(frame.stamp / 1e9, 3) for frame in shown] == [10.0, 10.033, 10.067]


def test_a_simulation_that_starts_again_does_not_stop_a_recording(
    clock: SimulatedClock, tick: Tick, tmp_path: Path
) -> None:
    """The frames continue at the new time."""
    shown, thread = _played(tmp_path, clock, 3)
    wait_until(lambda: len(shown) == 1, "the first frame")
    tick(2)
    wait_until(lambda: len(shown) == 2, "the second frame")
    tick(2.1)
    thread.join(PATIENCE_S)
    assert [round(frame.stamp / 1e9, 3) for frame in shown] == [10.0, 2.0, 2.033]


def test_a_simulation_may_start_again_while_a_frame_is_in_use(
    clock: SimulatedClock, tick: Tick, tmp_path: Path
) -> None:
    """The time that the last frame had tells that the clock has jumped back before the player waits."""
    for number in range(2):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full((8, 8), number, np.uint8))
    with open_source(str(tmp_path)) as source:
        frames = play(source, clock=clock)
        assert next(frames).stamp == 10_000_000_000
        tick(2)
        assert next(frames).stamp == 2_000_000_000


def test_images_without_stamps_get_the_time_of_the_simulation(graph: Graph, clock: SimulatedClock, tick: Tick) -> None:
    """A stamp that an image has is kept."""
    publisher = MemoryMiddleware(graph).publisher("/image", Image, Qos())
    tick(20)
    pixels = np.zeros((4, 6, 3), np.uint8)
    with TopicSource(MemoryMiddleware(graph), "/image", print, clock) as source:
        frames = iter(source)
        publisher.publish([cdr.encode(image(pixels, "rgb8", 0))])
        assert next(frames).stamp == 20_000_000_000
        publisher.publish([cdr.encode(image(pixels, "rgb8", 7))])
        assert next(frames).stamp == 7
