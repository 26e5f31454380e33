"""Settings of all tests of roverkit."""

import os

os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # a small network runs sooner than XLA has optimized it
