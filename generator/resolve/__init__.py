"""Conversion of the table and the schema of the protos to the IR."""
