"""Generation of files from the IR."""
