"""Accuracy and speed of the rover's eyes on rendered frames, whose truth is known: python -m bench.vision."""
