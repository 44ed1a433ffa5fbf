"""The README's picture: the carried net at three times, and the sway of its middle at three stiffnesses.

Run as `python -m studies.shown.picture`; it writes `studies/net.png`.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from anet_lumped import load_scene, simulate
from anet_lumped.views.palette import BLUE, ORANGE
from anet_lumped.views.run_figure import mark_failures
from studies.shown.sentences import stiffness

HERE = Path(__file__).parents[1]


def draw():
    """The figure."""
    scene = load_scene("net_carried")
    figure = Figure(figsize=(10, 3.6), layout="constrained")
    side, sway = figure.subplots(1, 2, width_ratios=(1.5, 1))
    runs = []
    for EA, dashes in ((1e4, "-"), (1e6, "--"), (1e8, ":")):
        cables = tuple(replace(cable, EA=EA) for cable in scene.cables)
        run = simulate(replace(scene, cables=cables), 4.0, method="edmc", dt=0.01, save_every=0.01, audit=True)
        runs.append(run)
        middle = np.mean([run.position(f"s{i}") for i in range(4)], axis=0)
        label = stiffness(EA)
        sway.plot(run.t, 1e3 * (run.position("p0") - middle)[:, 0], dashes, label=label)
    p0 = run.position("p0")
    for k, alpha in ((0, 0.25), (200, 0.5), (400, 1.0)):
        for cable in scene.cables:
            shape = run.shape(cable.name)[k]
            side.plot(shape[:, 0], shape[:, 2], ".-", color=BLUE, alpha=alpha, ms=3, lw=1.2)
            side.plot(*shape[0, [0, 2]], "s", color="k", alpha=alpha, ms=5)
        side.plot(*p0[k, [0, 2]], "o", color=ORANGE, alpha=alpha, ms=7)
        side.text(p0[k, 0], p0[k, 2] - 0.045, f"t = {run.t[k]:.0f} s", ha="center", va="top", fontsize=8)
    side.plot(p0[:, 0], p0[:, 2], color=ORANGE, lw=1)
    side.set(xlabel="x [m]", ylabel="z [m]", ylim=(-0.82, 0.08), aspect="equal")
    side.set_title("The net under four corners that move at 0.2 m/s")
    sway.set(xlabel="t [s]", ylabel="sway of p0 [mm]", ylim=(-20, 16), title="edmc at 10 ms, at any stiffness")
    sway.legend(frameon=False, fontsize=8, loc="lower center", ncols=3)
    for panel in (side, sway):
        panel.spines[["top", "right"]].set_visible(False)
    mark_failures(figure, *runs)
    return figure


if __name__ == "__main__":
    draw().savefig(HERE / "net.png", dpi=90)
