"""How air and water move: winds and currents, and waves; and what water does to cables, at rest or moving (`water_on_cables`).

A user describes a wind or a wave by a frozen dataclass. Compiled functions beside it evaluate it.
"""
