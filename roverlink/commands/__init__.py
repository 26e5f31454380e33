"""Commands, one module each: `add` declares the command, `run` runs it."""
