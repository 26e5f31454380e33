"""What is requested from a camera, and sources that do not have a setting."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from unittest.mock import Mock

import cv2
import numpy as np
import pytest
from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.frames import open_source

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK

_MJPG = cv2.VideoWriter_fourcc(*"MJPG")


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The V4L2 cameras that were opened; each takes over what it knows, and limits its gain to 100."""
    opened: list[Any] = []

    def open_camera(*what: object) -> Any:
        now, requests = {cv2.CAP_PROP_FPS: 30.0}, list[tuple[int, float]]()

        def set_value(key: int, value: float) -> bool:
            requests.append((key, value))
            now[key] = min(value, 100) if key == cv2.CAP_PROP_GAIN else value
            return True

        driver = Mock(what=what, requests=requests)
        driver.isOpened.return_value = driver.grab.return_value = True
        driver.retrieve.return_value = True, np.zeros((4, 6, 3), np.uint8)
        driver.getBackendName.return_value = "TEST"
        driver.set, driver.get = set_value, lambda key: now.get(key, 0.0)
        opened.append(driver)
        return driver

    monkeypatch.setattr(cv2, "VideoCapture", open_camera)
    return opened


def test_settings_are_requested_from_the_driver(camera: list[Any]) -> None:
    """The format is first, because sizes depend on it; exposure and focus end what is automatic, in V4L2's units."""
    said = list[str]()
    settings = CameraSettings(format="MJPG", rate=60, exposure=5, gain=50, focus=30)
    with open_source("/dev/video2", settings, size=(1280, 720), say=said.append):
        pass
    assert [one.what for one in camera] == [(2, cv2.CAP_V4L2)]
    assert camera[0].requests == [
        (cv2.CAP_PROP_FOURCC, _MJPG),
        (cv2.CAP_PROP_FRAME_WIDTH, 1280),
        (cv2.CAP_PROP_FRAME_HEIGHT, 720),
        (cv2.CAP_PROP_AUTO_EXPOSURE, 1),
        (cv2.CAP_PROP_AUTOFOCUS, 0),
        (cv2.CAP_PROP_FPS, 60),
        (cv2.CAP_PROP_EXPOSURE, 50),  # in 100 us
        (cv2.CAP_PROP_GAIN, 50),
        (cv2.CAP_PROP_FOCUS, 30),
    ]
    assert said == []


def test_what_was_not_asked_for_stays_and_what_is_not_taken_is_told(camera: list[Any]) -> None:
    """A camera keeps what its driver or v4l2-ctl has set; a value that it limits is told with the one that it has."""
    said = list[str]()
    for settings in (CameraSettings(), CameraSettings(gain=180)):
        with open_source("0", settings, say=said.append):
            pass
    assert camera[0].requests == []
    assert said == ["camera 0: the camera does not take the gain 180; it is 100"]


def test_the_latency_makes_stamps_earlier(camera: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """The stamp is that of the exposure."""
    monkeypatch.setattr(SYSTEM_CLOCK, "now", lambda: 5_000_000_000)
    with open_source("0", CameraSettings(latency=0.04)) as source:
        assert next(iter(source)).stamp == 4_960_000_000


@pytest.mark.parametrize(
    ("text", "given", "expected"),
    [
        ("{folder}", {"exposure": 5.0}, "the setting 'exposure' has no effect on this kind of source"),
        ("http://127.0.0.1:1/video", {"size": (6, 4)}, "the setting 'size' has no effect"),
        ("topic:/camera", {"latency": 0.1}, "topic:/camera: the setting 'latency' has no effect"),
        ("gstreamer:v4l2src", {"gain": 1.0}, "a GStreamer pipeline: the setting 'gain' has no effect"),
    ],
)
def test_a_source_without_a_setting_refuses_it(tmp_path: Path, text: str, given: dict[str, Any], expected: str) -> None:
    """A setting that is silently ignored would be believed."""
    with pytest.raises(SetupError, match=expected):
        open_source(text.format(folder=tmp_path), CameraSettings(**given), open_topic=lambda _: pytest.fail("opened"))
