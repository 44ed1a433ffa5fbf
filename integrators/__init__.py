"""Marching M dv/dt = f(t, q, v): schemes, Newton's method for a stage, steps and saving. Knows nothing of cables.

Read in this order: `system` (what is marched), `schemes.record` (what is known of a scheme), `schemes.verlet` and `schemes.edmc`
(two schemes), `marching.march` (how a motion is marched from a start to an end). `adapters` has solvers of other packages march it.
"""

import warnings

# First-class functions are what lets one compiled scheme serve every system; the one warning they raise says nothing else.
warnings.filterwarnings("ignore", message=".*First-class function type.*")
