"""What rows need, imported once in the process that workers are forked from."""

from importlib import import_module

for _name in ("anet_lumped.statics.equilibrium", "anet_lumped.motion.simulate", "studies.sweeping.sweep"):
    import_module(_name)
