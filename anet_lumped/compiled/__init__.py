"""What compiled code is made of: four numbers at once (`lanes`), derivatives (`dual`), and functions called by their address.

Nothing here knows a cable or a scene. The kernels of all rooms above use it.
"""
