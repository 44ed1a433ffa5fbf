"""Nets at rest: the equilibrium of the lumped chains, and the catenary and the catenary net that they are measured against."""
