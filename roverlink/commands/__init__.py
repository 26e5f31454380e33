"""Commands of ``roverlink``, one module each.

Each module has two functions: `add` adds the command and its options to the command line, and `run` executes the
command and returns the exit code.
"""
