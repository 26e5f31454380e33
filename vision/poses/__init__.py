"""Poses, and their computation from points."""
