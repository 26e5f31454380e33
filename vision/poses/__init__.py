"""Poses, and how they are computed from points."""
