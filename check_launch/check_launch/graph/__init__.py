"""Drawing of what a launch file starts."""
