"""Parts of ``roverlink demo``."""
