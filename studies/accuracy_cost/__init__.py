"""What the study `work_precision` is made of: motions, contestants, references, and comparison at equal error."""
