"""What compiled code is made of: four numbers at once (`lanes`), derivatives (`dual`), and functions called by their address.

Knows no cable and no scene; what it offers serves every kernel in the rooms above.
"""
