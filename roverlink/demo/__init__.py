"""The parts of ``roverlink demo``."""
