"""What accuracy costs: motions, the methods and engines that are timed on them, references, and comparisons at equal error.

Whatever a study says of two times comes from `paired_timing`.
"""
