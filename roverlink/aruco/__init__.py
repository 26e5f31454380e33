"""The parts of ``roverlink aruco``."""
