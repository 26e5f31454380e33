"""The parts that roverkit adds to `roverlink demo`: a rover that drives, its cameras, and the page with its video."""

from __future__ import annotations

import importlib.util
import math
import re
import time

import pytest
from needs import NO_AV, NO_OPENCV
from programs import Start
from roverkit.demo.demo_rover import DemoRover
from roverkit.demo.shuttle import START, Shuttle
from roverkit.driving.arcs import PlanarPose
from roverkit.simulation.rover_model import RoverModel

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.client import Received


@pytest.mark.slow
def test_the_rover_of_the_demo_drives_and_knows_where_it_is(done: Start) -> None:
    """In three seconds it drives, odometry and camera are near the truth, and all messages cross.

    They do so over DDS where that is installed.
    """
    code, output, _ = done("demo", "--seconds", 3)
    assert code == 0, output
    assert "21 of 21 messages bridged" in output

    def numbers(pattern: str) -> list[float]:
        found = re.search(pattern, output)
        assert found, f"{pattern}\n{output}"
        return [*map(float, found.groups())]

    driven, off = numbers(r"the rover drove ([\d.]+) m .*; its wheel odometry is (\d+) mm beside the truth")
    assert driven > 0
    assert off < 500  # a busy machine is late with some reports
    if importlib.util.find_spec("cv2"):
        frames, error = numbers(r"located the rover in (\d+) frames with 4 landmarks; largest error (\d+) mm")
        assert frames > 0
        assert error <= 30
    else:
        assert "pip install 'opencv-contrib-python-headless>=4.8'" in output


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("av"), reason=NO_AV)
def test_the_page_shows_the_video_of_the_camera_and_the_paths_of_the_rover(start: Start) -> None:
    """The video as it arrives; the true path and both estimated ones, landmarks; the end of the demo is told."""
    from rover.tests.vision.browsing import visiting  # it needs OpenCV

    demo = start("demo", "--seconds", 3600, "--middleware", "memory")
    told = "page with the video of the camera and the paths of the rover: http"
    url = demo.wait_for(told, demo.output).rpartition(": ")[2]
    with visiting() as visitor:
        visitor.open(url)
        camera = 'section[aria-label="camera"]'
        visitor.until(lambda: visitor.count(camera) and "images/s" in visitor.text(camera))
        visitor.until(lambda: visitor.run(f"return document.querySelector('{camera} img').naturalWidth") == 640)
        visitor.until(lambda: "wheel odometry" in visitor.text("#map-note"))
        for path in ("true", "estimated", "odometry"):  # 2.2 m along x
            box = f"return document.querySelector('#map .{path}').getBBox()"
            visitor.until(lambda box=box: 1.5 < visitor.run(box)["width"] < 3)
            assert visitor.run(box)["height"] < 1
        assert visitor.count("#map .landmark") == 4
        assert visitor.complaints() == []
        demo.interrupt()
        visitor.until(lambda: "NO CONNECTION" in visitor.text("#connection"))


class _NoBoards:
    """Boards whose datagrams go nowhere."""

    def send_datagram(self, datagram: bytes) -> None:
        """Forget it."""


def test_the_rover_moves_by_messages_on_drive_motor_alone() -> None:
    """It stands without one, and drives the distance of one; other payloads do not matter."""
    rover, command = DemoRover(REGISTRY), REGISTRY.by_name["drive_motor"]

    def drive(payload: Received | None) -> float:
        before = rover.pose
        if payload:
            rover.receive("hardware", payload)
        for _ in range(300):
            rover.step({"hardware": _NoBoards()})  # type: ignore[dict-item]
        return rover.pose.distance_to(before)

    assert drive(None) == 0
    other = REGISTRY.by_name["arm_target"]
    assert drive(Received(other.route.number, payload_at(other.payload_type, 1.0))) == 0
    payload = command.payload_type(distance_to_go=0.5)
    assert drive(Received(command.route.number, payload)) == pytest.approx(0.5, abs=0.15)  # with slip
    assert "the rover drove 0.5 m" in rover.stop()


@pytest.mark.slow
def test_slip_does_not_carry_the_rover_away() -> None:
    """For a minute, which is 24 m, it drives to and fro within its limits, and looks to the landmarks."""
    rover, driver = RoverModel(0, start=START), Shuttle()
    for _ in range(600):
        rover.command(driver.command(rover.pose))
        rover.advance(0.1)
        assert abs(rover.pose.yaw) < math.radians(28)  # half of what the camera sees
        assert abs(rover.pose.y) < 0.4
        assert -1.4 < rover.pose.x < 1.2
    assert rover.rolled > 20


def test_images_belong_to_poses_also_after_a_lost_connection() -> None:
    """A program that connects again goes on counting from the images that it got."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    from roverkit.demo.rover_images import SentImages

    sent = SentImages()
    sent.connect().extend(map(PlanarPose, range(3)))
    assert [sent.pose(number, time.time_ns()).x for number in (0, 1)] == [0, 1]  # the last image was lost
    sent.connect().extend(map(PlanarPose, range(3, 9)))
    assert [sent.pose(number, time.time_ns()).x for number in (2, 4)] == [3, 5]
