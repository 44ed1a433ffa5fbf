"""Marching a motion from a start to an end: fixed steps, chosen steps, events, saving.

`march` allocates what a march works in and calls one of the compiled loops, `fixed_steps`, `adaptive_steps` or `embedded_steps`.
"""
