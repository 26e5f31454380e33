"""Calibration while the camera runs: one thread brings frames, other threads bring the user's clicks.

The newest image and the state of the page are kept for any number of browsers. The calibration is computed on a thread
of its own, so that the image on the page continues to move.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from roverkit.calibration.collection import Collection, Offer
from roverkit.calibration.page.page_state import Taken, advice, collected
from roverkit.calibration.solution import Calibration, PoorViewsError
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.frames.newest import Newest
from roverkit.vision.markers.detection import Image, to_colour
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import RoverlinkError, SetupError

_TIMEOUT_S = 5.0
"""Longest time in seconds that a request for a new image or state waits."""
_SHOWN, _THUMBNAIL = 960, 240
"""Widths of the live image and of thumbnails in pixels."""
_QUALITY = (cv2.IMWRITE_JPEG_QUALITY, 75)
_MARK, _RIM = (0, 200, 255), (0, 0, 0)  # BGR

_COMPLETE = "Coverage is complete: calibrate now. More views do no harm."


class LiveCalibration:
    """Collects views from frames and carries out the user's clicks on the calibration page.

    It is the `PageBackend` of a `PageServer`: the object from which the HTTP server gets the state of the page.
    """

    def __init__(
        self,
        source: str,
        collection: Collection,
        calibrate: Callable[[tuple[View, ...]], Calibration],
        report: Callable[[Calibration], str],
        save: Callable[[Calibration], str],
    ) -> None:
        """Prepare the calibration of a camera.

        `source` is the name of the camera. `calibrate` computes a calibration from views. `report` returns the report
        of a calibration as HTML. `save` writes a calibration and returns a sentence that names the files. `calibrate`
        and `save` raise `RoverlinkError` if they fail.
        """
        self._source, self._collection = source, collection
        self._calibrate, self._report, self._save = calibrate, report, save
        self._lock = threading.Lock()  # protects the collection and the attributes below
        self._taken: tuple[Taken, ...] = ()
        self._calibration: Calibration | None = None
        self._refused: tuple[str, ...] = ()
        self._number, self._note, self._saved, self._warning = 1, "", "", ""
        self._calibrating, self._more = False, True
        self._asked = threading.Event()
        self.finished = threading.Event()
        """Set when the calibration has been saved."""
        self._images: Newest[tuple[Image, Floats]] = Newest()
        self._states: Newest[dict[str, Any]] = Newest()
        self._publish_state()

    # --- frames -----------------------------------------------------------------------------------------------------

    def add_frame(self, image: Image, stamp_ns: int, name: str, *, chosen: bool = False) -> Offer:
        """Examine a frame (H, W, 3), and return the result. A view that is taken gets the name `name`.

        The view in the frame is taken if it is useful, if the user has clicked "Take now", or if `chosen` is true: then
        the user has chosen the image.
        """
        with self._lock:
            if asked := self._asked.is_set():
                self._asked.clear()
            look = self._collection.take if chosen or asked else self._collection.offer
            offer = look(image, stamp_ns, name)
            self._note = offer.reason
            if offer.taken:
                self._warning = ""
                thumbnail = _jpeg(image, offer.view.corners, _THUMBNAIL)
                self._taken += (Taken(self._number, offer.view, thumbnail),)
                self._note = f"View {self._number} is taken: {offer.reason}"
                self._number += 1
            self._publish_state()
        self._images.put((image, offer.view.corners))
        return offer

    def warn(self, text: str) -> None:
        """Show a warning on the page until a view is taken."""
        with self._lock:
            self._warning = text
            self._publish_state()

    def ended(self) -> None:
        """Tell the page that no more frames come. Called when the source has ended."""
        with self._lock:
            self._more, self._note = False, f"{self._source} has ended; no more frames."
            self._publish_state()

    # --- the page: see `PageBackend` ----------------------------------------------------------------------------------

    def state(self, after: int) -> dict[str, Any]:
        """Return the state that the page shows, as JSON values; its number is the value of `version`.

        Waits some seconds for a state whose number is greater than `after`; then returns the newest state anyway.
        """
        version, state = self._states.get(after, _TIMEOUT_S) or self._states.now()
        return {"version": version, **state}

    def image(self, after: int) -> tuple[int, bytes] | None:
        """Return number and JPEG of the newest image, with its corners marked.

        Waits some seconds for a number greater than `after`; returns None if no such image comes.
        """
        newest = self._images.get(after, _TIMEOUT_S)
        return newest and (newest[0], _jpeg(*newest[1], _SHOWN))

    def thumbnail(self, view: int) -> bytes | None:
        """Return the thumbnail of the view with this number on the page, as JPEG; None if there is no such view."""
        return next((taken.thumbnail for taken in self._taken if taken.number == view), None)

    def report(self) -> str | None:
        """Return the report of the last calibration as HTML; None before the first calibration."""
        calibration = self._calibration
        return None if calibration is None else self._report(calibration)

    def act(self, action: str, view: int | None) -> None:
        """Carry out a click on the page: `take` a view, `drop` the view with the number `view`, `calibrate`, or `save`.

        Raises `RoverlinkError` if the action is not possible.
        """
        if action == "take":
            self._asked.set()
            return
        with self._lock:
            if self._calibrating and action != "drop":
                raise SetupError("wait until the calibration has finished")
            if action == "drop":
                self._drop(view)
            elif action == "calibrate":
                self._start()
            else:
                self._finish()
            self._publish_state()

    # --- with the lock held -----------------------------------------------------------------------------------------

    def _drop(self, number: int | None) -> None:
        found = [taken for taken in self._taken if taken.number == number]
        if not found:
            raise SetupError(f"view {number} does not exist; it may have been dropped already")
        self._collection.discard(found[0].view)
        self._taken = tuple(taken for taken in self._taken if taken is not found[0])

    def _start(self) -> None:
        self._calibrating, self._refused = True, ()
        threading.Thread(target=self._solve, args=(self._collection.views,), name="calibration").start()

    def _finish(self) -> None:
        if self._calibration is None:
            raise SetupError("nothing to save: calibrate first")
        self._saved = self._save(self._calibration)
        self.finished.set()

    def _publish_state(self) -> None:
        """Compute the state again and send it to the browsers. Called after every change."""
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
            return "The views are not sufficient for a calibration:"
        if self._calibration:
            return "Calibration finished. Check the result, then save it."
        if self._warning:
            return self._warning
        if self._collection.complete:
            return _COMPLETE
        return (
            advice(self._collection.missing) if self._more else "No more frames: calibrate with the views taken so far."
        )

    # --- the calibration's thread ------------------------------------------------------------------------------------

    def _solve(self, views: tuple[View, ...]) -> None:
        calibration = None
        refused: tuple[str, ...] = ("the calibration failed; the terminal shows the error",)
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
                self._publish_state()


def _jpeg(image: Image, corners: Floats, width: int) -> bytes:
    """Return an image as JPEG, at most `width` pixels wide, with corners (N, 2) marked."""
    scale = min(1.0, width / image.shape[1])
    small = cv2.resize(to_colour(image), None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    radius = max(1, small.shape[1] // 240)
    for x, y in np.rint(corners * scale).astype(int).tolist():
        cv2.circle(small, (x, y), radius + 1, _RIM, cv2.FILLED)
        cv2.circle(small, (x, y), radius, _MARK, cv2.FILLED)
    return bytes(cv2.imencode(".jpg", small, _QUALITY)[1])
