"""What accuracy costs on a deck: both codes with several settings in turn, each against a fine run of its own."""

import json
import math
from pathlib import Path

import numpy as np

from studies.peers.problem import explicit_limit
from studies.questions.moorings import decks
from studies.questions.moorings.motion import RK4_REACH, Peer, own_run, prepare, tensions

SAVED = 0.1  # [s]
REPEATS = 3
OWN_STEPS = (0.1, 0.05, 1 / 30, 0.025, 0.02, 1 / 60, 0.0125, 1 / 120, 0.00625, 0.003125)  # [s]
OWN_FINE = 0.1 / 128
OWN_METHODS = {
    "edmc": {},
    "edmc, rho_inf = 0.8": {"rho_inf": 0.8},
    "edmc, rho_inf = 0.8, extrapolated": {"rho_inf": 0.8, "extrapolate": True},
}
OWN_SHARES = (2.2, 1.8, 1.2, 0.95, 0.6)  # of the limit of rk4 in air, which water that moves with a cable raises
PEER_SETTINGS = {
    f"{scheme}, dt = {share:g} of its limit, coupled every {1e3 * coupling:g} ms": (scheme, share, coupling)
    for scheme, share in (("rk2", 0.6), ("rk4", 0.9))
    for coupling in (2.5e-2, 1e-2, 5e-3, 2.5e-3, 1.25e-3)
}
PEER_FINE = ("rk4", 0.3, 6.25e-4)
TOLERANCES = (0.01, 0.001)  # of the range of the tension
OWN, OTHER = "this library", "MoorDyn"
COLUMNS = ("deck", "code", "setting", "error_over_range", "cpu_s")


def cost_rows(row):
    """Errors and processor times of all settings on one deck, as JSON."""
    deck, _ = decks.read(row["file"])
    prepared, t_end = prepare(deck), row["t_end_s"]
    contestants, fine = {}, {}

    def own(**settings):
        run, cpu = own_run(prepared, t_end, save_every=SAVED, **settings)
        return tensions(deck, run)[1:] if run.status == "done" else None, cpu

    steps, repeats = ((0.05, 0.025), 1) if row["quick"] else (OWN_STEPS, REPEATS)
    fine[OWN] = own(method="edmc", dt=OWN_FINE * (8 if row["quick"] else 1))[0]
    for method, options in OWN_METHODS.items():
        for dt in steps:
            contestants[OWN, f"{method}, dt = {1e3 * dt:.4g} ms"] = lambda dt=dt, options=options: own(
                method="edmc", dt=dt, **options
            )
    limit = explicit_limit(deck.scene, RK4_REACH)
    for share in OWN_SHARES[-1:] if row["quick"] else OWN_SHARES:
        dt = SAVED / math.ceil(SAVED / (share * limit))  # so that steps end where tensions are compared
        contestants[OWN, f"rk4, dt = {1e3 * dt:.4g} ms"] = lambda dt=dt: own(method="rk4", dt=dt)
    if row["peer"]:
        other = Peer(row["file"], deck)
        _, _, state = other.rest(prepared.rest)

        def march(scheme, share, coupling):
            try:
                return other.march(state, t_end, SAVED, dt=share * other.limit, scheme=scheme, coupling=coupling)
            except RuntimeError:  # it diverges
                return None, np.nan

        fine[OTHER] = march(*PEER_FINE)[0]
        for name, setting in PEER_SETTINGS.items():
            contestants[OTHER, name] = lambda setting=setting: march(*setting)
    found = {key: [] for key in contestants}
    for _ in range(repeats):
        for key, contest in contestants.items():
            found[key].append(contest())
    lines = []
    for (code, name), runs in found.items():
        at, reference = runs[0][0], fine[code]
        error = np.inf if at is None else float(np.abs(at - reference).max() / np.ptp(reference, axis=0).max())
        error = error if np.isfinite(error) else None
        cpu = min(cpu for _, cpu in runs)
        lines.append(dict(zip(COLUMNS, (Path(row["file"]).name, code, name, error, cpu), strict=True)))
    return {"settings": json.dumps(lines)}


def cheapest(cost, deck, code, tolerance):
    """The line of the cheapest setting of a code on a deck that is within a tolerance, or None."""
    part = cost[(cost["deck"] == deck) & (cost["code"] == code) & (cost["error_over_range"] <= tolerance)]
    return None if part.empty else part.loc[part["cpu_s"].idxmin()]


def ratio(cost, deck, tolerance):
    """How many times less processor time than MoorDyn this library takes, or NaN."""
    own, other = (cheapest(cost, deck, code, tolerance) for code in (OWN, OTHER))
    return np.nan if own is None or other is None else float(other["cpu_s"] / own["cpu_s"])
