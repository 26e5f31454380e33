"""The table and the proto schema, resolved to the IR."""
