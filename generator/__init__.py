"""Compiler from mapping.yaml to files: read, resolve, lint, emit, write.

`roverlink.generator.pipeline` compiles a table, `roverlink.generator.emit.writer` writes the result, and
`roverlink.generator.lint.project` lints without loading the targets.
"""

if __name__ != "roverlink.generator":
    raise ImportError("'generator' is a folder of this repository, not a package; import roverlink.generator")
