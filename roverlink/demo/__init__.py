"""Simulated camera of ``roverlink demo``, and the rendered scene that this camera sees."""
