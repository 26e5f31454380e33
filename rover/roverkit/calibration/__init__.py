"""Camera calibration with printed boards. The calibration estimates its own error.

A view is the set of board corners found in one image. A `Collection` takes views of a `CalibrationBoard` from frames
and tells which views are missing. `calibrate` computes a `Calibration` from the views: the camera's parameters, their
standard deviations, the result of each view, and the uncertainty over the image.
"""

from roverkit.calibration.april_grid import AprilGrid
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.charuco_board import CharucoBoard
from roverkit.calibration.chessboard import Chessboard
from roverkit.calibration.collection import Collection, Offer
from roverkit.calibration.coverage import Coverage, Need
from roverkit.calibration.solution import Calibration, Fitted, Model, PoorViewsError
from roverkit.calibration.solver import calibrate
from roverkit.calibration.verdict import Doubt, Judgement, Verdict
from roverkit.calibration.views import BoardDetector, View

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
