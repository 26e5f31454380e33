"""Simulation of boards and a basestation, and the final check that no datagram is unaccounted for."""
