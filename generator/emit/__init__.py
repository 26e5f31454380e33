"""Generation of files from the IR, the checked content of mapping.yaml and the .proto files."""
