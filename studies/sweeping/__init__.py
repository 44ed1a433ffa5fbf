"""Sweeps: what is varied, what is measured, and rows that run in parallel.

Each row reaches the disk as it comes, so that a sweep that is stopped or killed goes on where it was. Studies use the same rows.
"""
