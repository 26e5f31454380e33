"""Poses, and their computation from the corners of markers."""
