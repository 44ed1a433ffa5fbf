"""Random trials: run as `python -m studies.fuzz`, see `studies.catalogue.random_trials`."""

from studies.catalogue.random_trials import main

if __name__ == "__main__":
    main()
