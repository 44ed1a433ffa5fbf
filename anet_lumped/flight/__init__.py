"""What flies: shells over a `Session` for those who control the points that carry a net."""
