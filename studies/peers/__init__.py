"""Other engines that simulate the scenes of this package, each behind the same names.

A peer is a module with ``NAME``, ``DESCRIPTION``, ``version()`` (None where the engine is not installed), ``refuses(scene)``
(why it cannot do a scene, or None), ``settings(scene)`` (keyword arguments of ``run`` from coarse to fine) and
``run(scene, t_end, save_every, start=None, **setting)``, which returns an `Outcome`. No engine is imported before it is asked
for.
"""

from importlib import import_module

from anet_lumped.checks import InputError, shown
from studies.peers.problem import Outcome

__all__ = ["PEERS", "Outcome", "installed", "peer"]

PEERS = ("moordyn", "exudyn", "mujoco", "drake", "cabledyn")


def peer(name):
    """The module of a peer.

    Raises
    ------
    InputError : a name that is not one of `PEERS`
    """
    if name not in PEERS:
        raise InputError(f"A peer must be one of {', '.join(PEERS)}, but it is {shown(name)}.")
    return import_module(f"studies.peers.{name}")


def installed():
    """Modules of the peers whose engine is installed, in the order of `PEERS`."""
    return [module for module in map(peer, PEERS) if module.version() is not None]
