"""Monitoring of a running bridge, for people and for programs.

A thread of its own reads the bridge's counters a few times a second, and computes the rates of messages and the time
since the last one. The bridge's threads only measure how long each batch took.
"""
