"""One module a command: `add` declares it, `run` does it."""
