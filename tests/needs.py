"""Reasons to skip a test, in the words that pytest's last line adds up; the command in brackets cures them."""

from __future__ import annotations

import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from roverlink.runtime.native.core import LIBRARY

SLOW = "slow (make test-all)"
EXHAUSTIVE = "exhaustive (make exhaustive)"
NO_DDS = "need Cyclone DDS (no wheel for this machine)"
NO_ZENOH = "need zenoh (make test-all)"
NO_ZENOH_JUDGES = "need zenoh-ros2-sdk and pamoja-ros2 (make test-all)"
NO_CAN = "need python-can, can-isotp and msgpack (make test-all)"
NO_OPENCV = "need OpenCV (make test-all)"
NO_SCIPY = "need SciPy (make test-all)"
NO_JAX = "need jax, optax and onnx (make test-all)"
NO_ONNX = "need ONNX Runtime and onnx (make test-all)"
NO_GTSAM = "need GTSAM (make test-all)"
NO_AV = "need PyAV (make test-all)"
NO_FOXGLOVE = "need foxglove-sdk (make test-all)"
NO_PYARROW = "need pyarrow (make test-all)"
NO_PYPDFIUM2 = "need pypdfium2 (make test-all)"
NO_ROS = "need ROS 2's tools and C++ libraries (xargs apt-get install <tests/ros/debian-packages)"
NO_NANOPB = "need nanopb (apt-get install gcc libnanopb-dev; pip install nanopb)"
NO_RCLPY = "need a real ROS 2 (make test-ros2)"
NO_NATIVE = "need the native core (pip install -e . where a C++ compiler is)"
NOT_LINUX = "need Linux"

needs_native = pytest.mark.skipif(not LIBRARY.is_file(), reason=NO_NATIVE)
needs_dds = pytest.mark.skipif(not find_spec("cyclonedds"), reason=NO_DDS)
needs_jax = pytest.mark.skipif(not all(map(find_spec, ("jax", "optax", "onnx"))), reason=NO_JAX)
HAS_NANOPB = bool(shutil.which("gcc") and Path("/usr/include/pb_decode.h").exists() and find_spec("nanopb"))
needs_nanopb = pytest.mark.skipif(not HAS_NANOPB, reason=NO_NANOPB)
needs_linux = pytest.mark.skipif(sys.platform != "linux", reason=NOT_LINUX)
