"""`make bench`: how fast the bridge is, beside the ways one would otherwise build it.

One module is one section of the report: a function that takes the `Lab` and returns a `SectionResult` (tables, charts,
data). `__main__.SECTIONS` lists them; printing, drawing and JSON know only these types. Nothing here asserts a time.
"""
