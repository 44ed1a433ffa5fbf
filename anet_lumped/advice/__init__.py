"""What a user should choose: segments, method and step for an error, the effects that a scene needs.

And how far the lumped model is from the catenary or from measured markers.
"""
