"""The largest datagram. The table and the runtime have the same limit."""

from __future__ import annotations

LARGEST_DATAGRAM = 65_507
"""Largest payload of a UDP datagram over IPv4 in bytes: 65,535 minus the IP header (20) and the UDP header (8)."""
