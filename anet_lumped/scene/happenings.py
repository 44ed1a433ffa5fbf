"""What a scene may say that happens in a run: at given times, and where cables pull too hard."""

from .cable_cut import CableCut
from .payload_change import PayloadChange
from .release import Release

Happening = PayloadChange | CableCut | Release
KINDS = {"payload_change": PayloadChange, "cable_cut": CableCut, "release": Release}
