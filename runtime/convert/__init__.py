"""Conversions that generated code imports: well-known types, oneofs, maps and rotations."""
