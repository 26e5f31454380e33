"""What ends the bench with a message instead of a traceback."""


class BenchError(Exception):
    """The bench, or one of the programs it measures, cannot run; the text says why and what to do."""
