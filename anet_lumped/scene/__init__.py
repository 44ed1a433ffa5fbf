"""What a user writes: points, cables, ropes, changes of payload, and the `Scene` that holds them, checked when made.

A scene is never changed; it is the same whether made in Python or from the plain dicts of a scene file (`as_dict`).
"""
