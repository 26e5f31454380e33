"""Modules that only the commands ``roverlink aruco ...`` use."""
