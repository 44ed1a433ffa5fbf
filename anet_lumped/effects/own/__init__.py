"""Effects that a user writes: a law in plain Python, checked, compiled, and differentiated by dual numbers."""
