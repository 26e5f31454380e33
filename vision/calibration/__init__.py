"""Calibration of cameras with ChArUco boards, which knows its own error.

A `Collection` takes views of a `CharucoBoard` from frames and knows what is missing; `calibrate` makes a `Calibration`
of them: the camera, standard deviations, what became of each view, and how uncertain each part of the image is.
"""

from roverlink.vision.calibration.board import CharucoBoard
from roverlink.vision.calibration.collection import Collection, Offer
from roverlink.vision.calibration.coverage import Coverage, Need
from roverlink.vision.calibration.solution import Calibration, Fitted, Model, PoorViewsError
from roverlink.vision.calibration.solver import calibrate
from roverlink.vision.calibration.views import BoardDetector, View

__all__ = [
    "BoardDetector",
    "Calibration",
    "CharucoBoard",
    "Collection",
    "Coverage",
    "Fitted",
    "Model",
    "Need",
    "Offer",
    "PoorViewsError",
    "View",
    "calibrate",
]
