"""Implementation of ``roverlink rocks``."""
