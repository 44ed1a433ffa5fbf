"""What flies: quadrotors and their controllers, and shells over a `Session` for those who control the points that carry a net."""
