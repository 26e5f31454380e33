"""The lint: the context that rules read, the rules, and the engine that runs them."""
