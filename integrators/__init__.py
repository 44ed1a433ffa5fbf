"""Marching M dv/dt = f(t, q, v): schemes, Newton's method for a stage, steps and saving. Knows nothing of cables."""

import warnings

from numba.core.errors import NumbaExperimentalFeatureWarning

# First-class functions are what lets one compiled scheme serve every system; the one warning they raise says nothing else.
warnings.filterwarnings("ignore", category=NumbaExperimentalFeatureWarning, message=".*First-class function type.*")
