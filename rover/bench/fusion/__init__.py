"""Judges of ``roverlink fuse``: recorded drives of other people, and other filters with the same inputs."""
