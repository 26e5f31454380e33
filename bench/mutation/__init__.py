"""Mutation run: small faults in the code, and the tests that notice them."""
