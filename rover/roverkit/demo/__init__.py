"""Rover of ``roverlink demo`` with its driver, the simulated cameras, and the page with the video and a map."""
