"""From mapping.yaml to files: read, resolve, lint, emit, write.

Whoever compiles takes `generator.pipeline` and `generator.write`; whoever lints takes `generator.lint_engine`, and
does not load what writes Python.
"""
