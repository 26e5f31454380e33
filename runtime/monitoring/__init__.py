"""Monitoring of a running bridge: /diagnostics for ROS 2, metrics for Prometheus, and live topics for Foxglove.

A thread of its own reads the bridge's counters a few times a second, and computes the rates of messages and the time
since the last one. The bridge's threads only measure how long each batch took.
"""
