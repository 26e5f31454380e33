"""Camera calibration with printed boards. The calibration estimates its own error.

A view is the set of board corners found in one image. A `Collection` takes views of a `CalibrationBoard` from frames
and tells which views are missing. `calibrate` computes a `Calibration` from the views: the camera's parameters, their
standard deviations, the result of each view, and the uncertainty over the image.
"""

from roverlink.vision.calibration.april_grid import AprilGrid
from roverlink.vision.calibration.board import CalibrationBoard
from roverlink.vision.calibration.charuco_board import CharucoBoard
from roverlink.vision.calibration.chessboard import Chessboard
from roverlink.vision.calibration.collection import Collection, Offer
from roverlink.vision.calibration.coverage import Coverage, Need
from roverlink.vision.calibration.solution import Calibration, Fitted, Model, PoorViewsError
from roverlink.vision.calibration.solver import calibrate
from roverlink.vision.calibration.verdict import Doubt, Judgement, Verdict
from roverlink.vision.calibration.views import BoardDetector, View

__all__ = [
    "AprilGrid",
    "BoardDetector",
    "Calibration",
    "CalibrationBoard",
    "CharucoBoard",
    "Chessboard",
    "Collection",
    "Coverage",
    "Doubt",
    "Fitted",
    "Judgement",
    "Model",
    "Need",
    "Offer",
    "PoorViewsError",
    "Verdict",
    "View",
    "calibrate",
]
