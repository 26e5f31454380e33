"""Resolution of the table and the proto schema to the IR."""
