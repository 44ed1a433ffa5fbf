"""Solvers of other packages on the same motions: what they are asked to do and what they leave, and an adapter for each package."""
