"""Accuracy and speed of the camera programs on rendered frames with known truth: python -m rover.bench.vision."""
