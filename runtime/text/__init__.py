"""Conversion of messages, payloads and YAML to and from text that people read and write."""
