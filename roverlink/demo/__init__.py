"""Modules that only ``roverlink demo`` uses."""
