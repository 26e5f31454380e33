"""Expansion of launch files: which nodes they start, with which parameters, names and remappings."""
