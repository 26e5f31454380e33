"""Rules about the numbers of the envelope."""
