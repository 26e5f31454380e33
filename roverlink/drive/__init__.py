"""Implementation of ``roverlink drive``: velocities and paths become commands for the driving board."""
