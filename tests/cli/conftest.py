"""The fixtures of the tests of commands."""

from command_fixtures import bridge, called, own_domain, own_signals, peer

__all__ = ["bridge", "called", "own_domain", "own_signals", "peer"]
