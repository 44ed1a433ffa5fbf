"""What a scene may say that happens at given times of a run."""

from .cable_cut import CableCut
from .payload_change import PayloadChange

Happening = PayloadChange | CableCut
KINDS = {"payload_change": PayloadChange, "cable_cut": CableCut}
