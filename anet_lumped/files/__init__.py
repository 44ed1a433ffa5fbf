"""Files that scenes come from and go to: TOML, and MoorDyn's input files."""
