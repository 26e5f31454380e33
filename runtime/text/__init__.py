"""Messages, payloads and YAML as people write and read them."""
