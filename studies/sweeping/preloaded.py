"""What rows need, imported once in the process that workers are forked from."""

import logging
import os
from importlib import import_module

os.environ["ANET_LUMPED_QUIET"] = "1"  # the process that began this one tells that it compiles
logging.getLogger("integrators").setLevel(logging.ERROR)  # and that it cannot keep compiled code

for _name in ("anet_lumped.statics.equilibrium", "anet_lumped.motion.simulate", "studies.sweeping.sweep"):
    import_module(_name)
