"""How air and water move: winds and currents, and waves.

What a user gives is a frozen dataclass; a kernel beside it evaluates all kinds in compiled code.
"""
