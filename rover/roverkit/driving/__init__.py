"""Driving: arcs on the ground, commands for the driving board, and the rover's position from what the board reports."""
