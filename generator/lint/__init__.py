"""The lint: what the rules may look at, the rules, and the engine that asks them."""
