"""The linear system of a Newton step: nodes of a cable one after the other, then the junctions; O(n) in the segments."""
