"""What comes back: a `State` at one time, a `Run` over many, its events, its account of energy, its audit and its file."""
