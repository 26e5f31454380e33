"""Lint of mapping.yaml and the .proto files: the rules, the data that rules may read, and the engine that runs them."""
