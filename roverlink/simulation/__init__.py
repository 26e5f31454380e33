"""Simulated boards and basestation, and a check at the end that each datagram was bridged or dropped for a reason."""
