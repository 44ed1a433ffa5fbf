"""How air and water move: winds and currents, and waves.

A user describes a wind or a wave by a frozen dataclass. Compiled functions beside it evaluate it.
"""
