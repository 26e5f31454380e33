"""Benchmarks of `make bench`: the speed of the bridge, compared with other ways to build one.

Each module is one section of the report: a function that takes the `Lab` and returns a `SectionResult` (tables, charts,
data). `__main__.SECTIONS` lists them; printing, drawing and JSON use only these types. No benchmark asserts a time.
"""
