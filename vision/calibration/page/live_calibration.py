"""A calibration while the camera runs: frames come from one thread, clicks from others.

What came of each frame is put where any number of browsers find the newest. The calibration itself has a thread of its
own, so that the picture goes on meanwhile.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from roverlink.runtime.core.errors import RoverlinkError, SetupError
from roverlink.vision.calibration.collection import Collection, Offer
from roverlink.vision.calibration.page.newest import Newest
from roverlink.vision.calibration.page.page_state import Taken, advice, collected
from roverlink.vision.calibration.solution import Calibration, PoorViewsError
from roverlink.vision.calibration.views import View
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.detection import Image
from roverlink.vision.opencv import cv2

_PATIENCE_S = 5.0
"""For which a browser that asks for news is kept waiting."""
_SHOWN, _THUMBNAIL = 960, 240
"""Widths of the pictures in pixels."""
_QUALITY = (cv2.IMWRITE_JPEG_QUALITY, 75)
_MARK, _RIM = (0, 200, 255), (0, 0, 0)  # blue green red

_COMPLETE = "There is all that a good calibration needs: calibrate. More views do no harm."


class LiveCalibration:
    """Collects views from frames, and does what is clicked: the `Desk` of a `PageServer`."""

    def __init__(
        self,
        source: str,
        collection: Collection,
        calibrate: Callable[[tuple[View, ...]], Calibration],
        report: Callable[[Calibration], str],
        save: Callable[[Calibration], str],
    ) -> None:
        """`source` names the camera; `report` makes HTML; `save` writes a calibration and says where it is.

        `calibrate` and `save` raise `RoverlinkError` where that cannot be done.
        """
        self._source, self._collection = source, collection
        self._calibrate, self._report, self._save = calibrate, report, save
        self._lock = threading.Lock()  # of the collection, and of what is set below
        self._taken: tuple[Taken, ...] = ()
        self._calibration: Calibration | None = None
        self._refused: tuple[str, ...] = ()
        self._number, self._note, self._saved = 1, "", ""
        self._calibrating, self._more = False, True
        self._asked = threading.Event()
        self.finished = threading.Event()
        """Set once the calibration is saved."""
        self._pictures: Newest[tuple[Image, Floats]] = Newest()
        self._states: Newest[dict[str, Any]] = Newest()
        self._tell()

    # --- frames -----------------------------------------------------------------------------------------------------

    def look(self, image: Image, stamp_ns: int, name: str, *, chosen: bool = False) -> Offer:
        """Look at a frame (H, W, 3); take it if it adds something, if somebody asked for it, or if it is `chosen`.

        `name` is what its view is called.
        """
        with self._lock:
            if asked := self._asked.is_set():
                self._asked.clear()
            look = self._collection.take if chosen or asked else self._collection.offer
            offer = look(image, stamp_ns, name)
            self._note = offer.reason
            if offer.taken:
                thumbnail = _jpeg(image, offer.view.corners, _THUMBNAIL)
                self._taken += (Taken(self._number, offer.view, thumbnail),)
                self._note = f"View {self._number} is taken: {offer.reason}"
                self._number += 1
            self._tell()
        self._pictures.put((image, offer.view.corners))
        return offer

    def ended(self) -> None:
        """Say that no more frames come."""
        with self._lock:
            self._more, self._note = False, f"{self._source} has ended."
            self._tell()

    # --- the page: see `Desk` -----------------------------------------------------------------------------------------

    def state(self, after: int) -> dict[str, Any]:
        """All that the page shows, newer than `after` if it changes in time."""
        version, state = self._states.get(after, _PATIENCE_S) or self._states.now()
        return {"version": version, **state}

    def picture(self, after: int) -> tuple[int, bytes] | None:
        """The newest picture, with the corners that were seen; None where none is newer than `after` in time."""
        newest = self._pictures.get(after, _PATIENCE_S)
        return newest and (newest[0], _jpeg(*newest[1], _SHOWN))

    def thumbnail(self, view: int) -> bytes | None:
        """A view's picture."""
        return next((one.thumbnail for one in self._taken if one.number == view), None)

    def report(self) -> str | None:
        """The report of the last calibration."""
        calibration = self._calibration
        return None if calibration is None else self._report(calibration)

    def act(self, action: str, view: int | None) -> None:
        """Do what was clicked; raises `RoverlinkError` where that cannot be done."""
        if action == "take":
            self._asked.set()
            return
        with self._lock:
            if self._calibrating and action != "drop":
                raise SetupError("wait until the calibration is done")
            if action == "drop":
                self._drop(view)
            elif action == "calibrate":
                self._start()
            else:
                self._finish()
            self._tell()

    # --- with the lock held -----------------------------------------------------------------------------------------

    def _drop(self, number: int | None) -> None:
        found = [one for one in self._taken if one.number == number]
        if not found:
            raise SetupError(f"there is no view {number}")
        self._collection.discard(found[0].view)
        self._taken = tuple(one for one in self._taken if one is not found[0])

    def _start(self) -> None:
        self._calibrating, self._refused = True, ()
        threading.Thread(target=self._solve, args=(self._collection.views,), name="calibration").start()

    def _finish(self) -> None:
        if self._calibration is None:
            raise SetupError("there is nothing to save: calibrate first")
        self._saved = self._save(self._calibration)
        self.finished.set()

    def _tell(self) -> None:
        """Let the page know how things are."""
        offered = {
            "take": self._more,
            "calibrate": bool(self._taken) and not self._calibrating,
            "save": self._calibration is not None and not self._calibrating,
        }
        self._states.put(
            {
                "source": self._source,
                "note": self._note,
                "status": self._status(),
                "refused": list(self._refused),
                "can": [action for action, possible in offered.items() if possible and not self._saved],
                "finished": bool(self._saved),
                **collected(self._collection, self._taken, self._calibration),
            }
        )

    def _status(self) -> str:
        if self._saved:
            return f"{self._saved} This page can be closed."
        if self._calibrating:
            return "Calibrating. This takes some seconds."
        if self._refused:
            return "This is not enough for a calibration:"
        if self._calibration:
            return "Calibrated. Look at the result, then save it."
        if self._collection.complete:
            return _COMPLETE
        return advice(self._collection.missing) if self._more else "Calibrate with what there is."

    # --- the calibration's thread ------------------------------------------------------------------------------------

    def _solve(self, views: tuple[View, ...]) -> None:
        calibration = None
        refused: tuple[str, ...] = ("the calibration failed: the terminal says how",)
        try:
            calibration, refused = self._calibrate(views), ()
        except PoorViewsError as error:
            refused = error.reasons
        except RoverlinkError as error:
            refused = (str(error),)
        finally:
            with self._lock:
                self._calibration = calibration or self._calibration
                self._calibrating, self._refused = False, refused
                self._tell()


def _jpeg(image: Image, corners: Floats, width: int) -> bytes:
    """A picture as JPEG, not wider than `width`, with its corners (N, 2) marked."""
    scale = min(1.0, width / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    radius = max(1, small.shape[1] // 240)
    for x, y in np.rint(corners * scale).astype(int).tolist():
        cv2.circle(small, (x, y), radius + 1, _RIM, cv2.FILLED)
        cv2.circle(small, (x, y), radius, _MARK, cv2.FILLED)
    return bytes(cv2.imencode(".jpg", small, _QUALITY)[1])
