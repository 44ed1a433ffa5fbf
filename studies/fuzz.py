"""Random trials: run as `python -m studies.fuzz`, see `catalogue.random_trials`, or with `rests`, see `catalogue.rest_trials`."""

import sys

from studies.catalogue import random_trials, rest_trials

if __name__ == "__main__":
    (rest_trials if sys.argv[1:] == ["rests"] else random_trials).main()
