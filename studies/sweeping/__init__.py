"""Sweeps: what is varied, what is measured, and rows that run in parallel, reach the disk as they come and resume after a kill."""
