"""What the page shows while frames come in, and what its buttons do."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import cache, partial
from itertools import count
from typing import Any

import cv2
import numpy as np
import pytest
from polling import PATIENCE_S, wait_until
from roverkit.calibration import Calibration, CharucoBoard, Collection, Fitted, Model, View
from roverkit.calibration.page.live_calibration import LiveCalibration
from roverkit.vision import Pose

from rover.tests.vision.board_frames import frame
from rover.tests.vision.boards import CAMERA
from roverlink.runtime.core.errors import SetupError

BOARD = CharucoBoard(7, 5, 0.038, 0.028)
FRAME_NS = 33_000_000


def shown(tilt: tuple[float, float], place: tuple[float, float], distance: float) -> np.ndarray:
    """A picture (H, W, 3) of the board."""
    return np.asarray(cv2.cvtColor(frame(tilt, place, distance, BOARD), cv2.COLOR_GRAY2BGR))


near = cache(partial(shown, (0, 0), (0.5, 0.5), 0.35))
left = cache(partial(shown, (0, 0), (0.3, 0.5), 0.5))
tilted = cache(partial(shown, (0, 29), (0.6, 0.5), 0.45))


def calibrated(views: tuple[View, ...]) -> Calibration:
    """A calibration of views, of which the second is said to be blurred."""
    pose = Pose(np.eye(3), np.array([0, 0, 1.0]))
    fitted = []
    for place, view in enumerate(views):
        count, is_blurred = len(view.ids), place == 1
        used = np.full(count, not is_blurred)
        fitted.append(Fitted(view, pose, np.full((count, 2), 0.1), used, "blurred" * is_blurred))
    return Calibration(CAMERA, Model.PLUMB_BOB, np.eye(9) * 0.01, 0.1414, tuple(fitted))


class _Camera:
    """Shows frames to a live calibration, each for as long as it takes to see that the board is still."""

    def __init__(self, *frames: np.ndarray, **changed: Callable[..., Any]) -> None:
        self._stamps = count(10**18, FRAME_NS)
        given: dict[str, Callable[..., Any]] = {
            "calibrate": calibrated,
            "report": lambda calibration: f"<p>{calibration.rms}",
            "save": lambda _: pytest.fail("saved"),
        }
        self.live = LiveCalibration("a camera", Collection(BOARD), **(given | changed))
        self.show(*frames)

    def show(self, *frames: np.ndarray) -> dict[str, Any]:
        """Show each frame twice; what the page then shows."""
        for image in frames:
            for _ in range(2):
                self.live.add_frame(image, next(self._stamps), "a frame")
        return self.state()

    def state(self) -> dict[str, Any]:
        return self.live.state(0)

    def calibrated(self, wanted: str = "result") -> dict[str, Any]:
        """Click on the button; what the page shows when it has a result, or the reasons of a refusal."""
        self.live.act("calibrate", None)
        wait_until(lambda: self.state()[wanted], wanted)
        return self.state()

    def refuses(self, action: str, words: str, view: int | None = None) -> None:
        """Demand that a click fails."""
        with pytest.raises(SetupError, match=words):
            self.live.act(action, view)


def goals(state: dict[str, Any]) -> dict[str, list[tuple[str, bool]]]:
    return {goal["name"]: [(part["text"], part["done"]) for part in goal["parts"]] for goal in state["goals"]}


@pytest.mark.slow
def test_views_that_add_something_are_taken() -> None:
    """Each with a number, its corners and a picture; what it covers is no longer missing, and a warning ends."""
    camera = _Camera()
    camera.live.warn("another board")
    assert camera.state()["status"] == "another board"
    state = camera.show(near(), left(), left(), tilted())
    assert [view["number"] for view in state["views"]] == [1, 2, 3]
    assert goals(state)["Views"] == [("3 of 20", False)]
    assert state["status"].startswith("Next: ")
    assert ("near 1/2", False) in goals(state)["Distance"]
    assert ("right edge nearer 1/2", False) in goals(state)["Tilt"]
    assert 14 not in state["coverage"]["missing"]  # just right of the middle
    assert 0 in state["coverage"]["missing"]
    picture = cv2.imdecode(np.frombuffer(camera.live.thumbnail(2) or b"", np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape == (180, 240, 3)


@pytest.mark.slow
def test_the_result_is_shown_and_the_report_is_there() -> None:
    """Numbers with intervals, errors of the views, the bad one named; and that it is of other views, once it is."""
    camera = _Camera(near(), left(), tilted())
    assert camera.live.report() is None
    state = camera.calibrated()
    assert state["result"]["numbers"][0] == ["fx", "920.00", "± 0.20"]
    assert [view["bad"] for view in state["views"]] == [False, True, False]
    assert [view["lines"][2] for view in state["views"][:2]] == ["error 0.141 px", "dropped: blurred"]
    assert [remark.split(" ")[0] for remark in state["result"]["remarks"]] == ["Judgement:", "RMS"]
    assert camera.live.report() == "<p>0.1414"
    camera.live.act("drop", 2)
    assert "calibrate again" in camera.state()["result"]["remarks"][2]
    assert camera.show(left())["views"][-1]["lines"][2] == "not used yet"


@pytest.mark.slow
def test_the_picture_goes_on_while_the_calibration_is_made() -> None:
    """Frames are looked at, and the buttons wait."""
    go = threading.Event()
    camera = _Camera(near(), left(), calibrate=lambda views: go.wait(PATIENCE_S) and calibrated(views))
    camera.live.act("calibrate", None)
    state = camera.show(tilted())
    assert state["status"].startswith("Calibrating")
    assert (len(state["views"]), state["can"]) == (3, ["take"])
    for action in ("calibrate", "save"):
        camera.refuses(action, "until the calibration has finished")
    go.set()
    wait_until(lambda: camera.state()["result"], "the result")
    assert camera.state()["can"] == ["take", "calibrate", "save"]


def test_what_is_saved_is_the_result() -> None:
    """Not before there is one, and not where it cannot be written, which can be tried again; and then it is over."""
    failures = ["a.yml: cannot write the file: no space"]
    saved: list[Calibration] = []

    def save(calibration: Calibration) -> str:
        if failures:
            raise SetupError(failures.pop())
        saved.append(calibration)
        return "Saved to a.yml."

    camera = _Camera(near(), left(), save=save)
    camera.refuses("save", "calibrate first")
    camera.calibrated()
    camera.refuses("save", "no space")
    assert not camera.live.finished.is_set()
    assert "save" in camera.state()["can"]
    camera.live.act("save", None)
    assert camera.live.finished.is_set()
    assert [len(one.views) for one in saved] == [2]
    assert camera.state()["finished"]
    assert camera.state()["status"] == "Saved to a.yml. This page can be closed."
