"""Command line: the only package that combines generator, runtime and vision."""
