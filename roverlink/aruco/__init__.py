"""Parts of ``roverlink aruco``."""
