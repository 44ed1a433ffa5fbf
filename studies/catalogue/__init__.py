"""Cases that are hard for any method, each with the physical statements that must hold, and random trials of all methods."""
