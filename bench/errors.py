"""Error type of the benchmarks: it ends them with a message instead of a traceback."""


class BenchError(Exception):
    """The benchmarks, or a program that they measure, cannot run; the text says why and what to do."""
