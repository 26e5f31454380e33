"""Compiler from mapping.yaml and .proto files to generated files: read, resolve, lint, emit, write.

`roverlink.generator.pipeline` compiles mapping.yaml. `roverlink.generator.emit.writer` writes the generated files to
disk. `roverlink.generator.lint.project` checks a project without generating files.
"""

if __name__ != "roverlink.generator":
    raise ImportError("'generator' is a folder of this repository, not a package; import roverlink.generator")
