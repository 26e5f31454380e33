"""Conversion of the table (mapping.yaml) and the schema of the .proto files to the IR.

The IR (intermediate representation) is the compiler's own model of the bridge. All files are generated from it.
"""
