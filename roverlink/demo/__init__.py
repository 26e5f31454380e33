"""Simulated cameras of ``roverlink demo``, the rendered scene that one of them sees, and the page with its video."""
