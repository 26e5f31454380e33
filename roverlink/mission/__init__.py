"""Implementation of ``roverlink mission``."""
