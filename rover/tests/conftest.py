"""What all tests of roverkit share."""

import os

os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # a small network runs sooner than XLA has optimized it
