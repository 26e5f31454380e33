"""Rules about rows, names and topics of the table."""
