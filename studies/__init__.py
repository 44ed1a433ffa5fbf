"""The application: the command line, sweeps, studies and the report."""
