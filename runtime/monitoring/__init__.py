"""How a bridge is doing, for people and programs that watch it.

A thread looks at the bridge's account a few times a second and works out rates and ages; the bridge's own thread does
nothing for it but to measure how long each batch took.
"""
