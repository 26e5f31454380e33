"""Declaration of the node of ``roverlink aruco calibrate``."""

from __future__ import annotations

from roverlink.nodes import NodeDeclaration

NODE = NodeDeclaration("camera_calibration", takes_images=True)
