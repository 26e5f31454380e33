"""Simulated boards and basestations, and the account of what they sent."""
