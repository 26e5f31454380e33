"""Simulated boards and basestations, and the final check of their counters."""
