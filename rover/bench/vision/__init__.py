"""Accuracy and speed of the camera programs on rendered frames with known truth: python -m rover.bench.vision."""

import roverkit  # noqa: F401  # before numpy, as in the programs, which it keeps from starting threads
