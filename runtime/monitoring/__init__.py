"""State of a running bridge, for people and programs that watch it.

A thread reads the bridge's counters a few times a second and computes rates and ages. The bridge's own threads only
measure how long each batch took.
"""
