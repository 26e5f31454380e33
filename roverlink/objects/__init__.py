"""Implementation of ``roverlink objects``."""
