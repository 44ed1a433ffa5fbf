"""Rigid bodies within the motion of the nodes.

A body is a set of nodes that move as one piece: its origin, a point on each of its axes, four masses that stand for it, see
`scene.body`, and its attachments, which hold halves of segments. Positions and velocities stay those of nodes. So forces, energies
and momenta need no word of bodies, and only three things are done here: what is left of the equations of its nodes are the six of
the body; a Newton step moves its nodes as one piece; velocities are those of one piece.
"""
