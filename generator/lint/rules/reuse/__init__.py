"""Rules about numbers and names that had another meaning in the past."""
