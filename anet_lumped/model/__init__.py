"""Scene → Model: the flat arrays that compiled code works on.

`build` cuts a scene into nodes and segments and chooses the order of elimination; `net` is the type that every kernel sees,
`tables` names every column; `remainder` is what is left of a scene after a break.
"""
