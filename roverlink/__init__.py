"""Command line of roverlink.

This is the only package that uses the generator, the runtime and the camera programs together.
"""
