"""Nets in motion: `simulate`, the choice of method and step, predicted stability, legs between events, and verdicts on a run."""
