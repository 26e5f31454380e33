"""Rules about what a launch file starts: parameters, plugins, topics and frames."""
