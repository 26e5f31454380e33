"""Functions that generated handlers call to convert well-known types, oneofs, maps and rotations."""
