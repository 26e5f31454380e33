"""Driving: arcs on the ground, commands for the driving board, and the rover's position from what the board reports."""

if __name__ != "roverlink.driving":
    raise ImportError("'driving' is a folder of this repository, not a package; import roverlink.driving")
