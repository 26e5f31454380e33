"""Reasons to skip a test, in the words that pytest's last line adds up; the command in brackets cures them."""

from __future__ import annotations

import sys
from importlib.util import find_spec

import pytest

SLOW = "slow (make test-all)"
EXHAUSTIVE = "exhaustive (make exhaustive)"
NO_DDS = "need Cyclone DDS (no wheel for this machine)"
NO_OPENCV = "need OpenCV (pip install 'opencv-contrib-python-headless>=4.8')"
NO_SCIPY = "need SciPy (pip install scipy)"
NO_JAX = "need jax, optax and onnx (pip install jax optax onnx)"
NO_ONNX = "need ONNX Runtime and onnx (pip install onnxruntime onnx)"
NO_GTSAM = "need GTSAM (pip install gtsam)"
NO_AV = "need PyAV (pip install av)"
NO_ROS = "need ROS 2's tools and C++ libraries (xargs apt-get install <tests/ros/debian-packages)"
NO_RCLPY = "need a real ROS 2 (make test-ros2)"
NOT_LINUX = "need Linux"

needs_dds = pytest.mark.skipif(not find_spec("cyclonedds"), reason=NO_DDS)
needs_jax = pytest.mark.skipif(not all(map(find_spec, ("jax", "optax", "onnx"))), reason=NO_JAX)
needs_linux = pytest.mark.skipif(sys.platform != "linux", reason=NOT_LINUX)
