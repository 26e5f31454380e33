"""Commands of ``roverlink``, one module each.

In each module, the function `add` adds the command to the command line, and `run` runs it and returns the exit code.
"""
