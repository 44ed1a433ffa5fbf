"""Random trials: run as `python -m studies.fuzz`, see `catalogue.random_trials`; with `rests`, see `catalogue.rest_trials`; with
`hostile`, see `catalogue.hostile_trials`.
"""

import sys

from studies.catalogue import hostile_trials, random_trials, rest_trials

TRIALS = {(): random_trials, ("rests",): rest_trials, ("hostile",): hostile_trials}

if __name__ == "__main__":
    TRIALS[tuple(sys.argv[1:])].main()
