"""Colours of a run that is looked at: a scale for tensions that grey prints and colour-blind readers keep in order.

Source: the scale is the darker part of "plasma" (S. van der Walt, N. Smith, matplotlib 1.5), the others are Okabe and Ito's.
"""

TENSION = ("#0d0887", "#43039e", "#6c00a8", "#920fa3", "#b32c8e", "#ce4b75", "#e4695e", "#f48948")
"""From no tension to the largest, evenly spaced."""

SLACK = "#8b959b"
POINTS = {"fixed": "#1d2428", "driven": "#0072B2", "free": "#D55E00"}
BODY = "#5b6b75"
GROUND, WATER, WIND, CURRENT, OBSTACLE = "#8a7a5c", "#56B4E9", "#009E73", "#0072B2", "#9aa5ad"
ENERGIES = {
    "kinetic": "#D55E00",
    "elastic": "#009E73",
    "potential": "#0072B2",
    "work put in": "#1d2428",
    "dissipated": "#CC79A7",
}
