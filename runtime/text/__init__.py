"""Text forms of messages, payloads and YAML, for people."""
