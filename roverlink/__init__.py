"""The command line: the one place that puts the generator and the runtime together."""
