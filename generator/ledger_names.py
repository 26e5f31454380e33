"""Names of the files with numbers that must never be used again."""

LEDGER = "mapping.lock"
"""Name of the ledger, beside mapping.yaml."""
ACCEPTED = "accepted-numbers.lock"
"""Name of the file with accepted numbers, in a folder of .proto files without a table."""
