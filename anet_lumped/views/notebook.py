"""What a notebook shows of a state or a run: what it is, what became of it, and a small picture."""

import base64
import io
from html import escape
from typing import Any

import numpy as np

from anet_lumped.checks import printable

from .verdict import as_length

MOST = 6  # cables whose tensions are listed


def state_html(state: Any) -> str:
    """HTML of a state: the tensions of the cables with the largest, and its shape."""
    rows = [("time", f"{state.t:.6g} s")]
    if state.residual is not None:
        rows.append(("out of balance", f"{state.residual:.1g} of the load"))
    if state.stable is not None:
        rows.append(("stable", "yes" if state.stable else "no"))
    peaks = sorted(((float(state.tension(c.name).max()), c.name) for c in state.scene.cables), reverse=True)
    rows += [(f"largest tension in {printable(name)}", f"{T:.4g} N") for T, name in peaks[:MOST]]
    return _page(repr(state)[1:-1], rows, [], state.plot())


def run_html(run: Any) -> str:
    """HTML of a run: how it ended, method and step, largest tension with its place and time, account, warnings, and pictures."""
    rows = [("status", run.status if run.ok else f"{run.status}: {run.message}"), ("method", f"{run.method}, dt = {run.dt:.3g} s")]
    rows.append(("time", f"{run.t[0]:.4g} to {run.t[-1]:.4g} s, {run.work.steps} steps, {run.wall_time:.2g} s to compute"))
    T = np.where(np.isfinite(run.segment_tension), run.segment_tension, 0.0)
    if T.size:
        k, _ = np.unravel_index(np.argmax(T), T.shape)
        name = max(run.scene.cables, key=lambda cable: T[k, run.model.segments(cable.name)].max()).name
        rows.append(("largest tension", f"{T.max():.4g} N in {printable(name)} at {run.t[k]:.4g} s"))
    if run.error_estimate is not None:
        rows.append(("error", f"places {as_length(run.error_estimate)}, largest tension {run.tension_error:.1%} (estimates)"))
    balance = run.energy_balance
    rows.append(("energy", f"{balance.in_play:.3g} J in play, {balance.lost_to_method:.2g} J taken by the method"))
    return _page(repr(run)[1:-1], rows, run.warnings, run.plot())


def _page(title: str, rows: list[tuple[str, str]], warnings: Any, figure: Any) -> str:
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=60)
    lines = "".join(
        f"<tr><th style='text-align:left'>{escape(a)}</th><td style='text-align:left'>{escape(b)}</td></tr>" for a, b in rows
    )
    told = "".join(f"<p><b>Warning:</b> {escape(text)}</p>" for text in warnings)
    data = base64.b64encode(picture.getvalue()).decode()
    return (
        f"<p><b>{escape(title)}</b></p><table>{lines}</table>{told}<img alt='{escape(title)}' src='data:image/png;base64,{data}'>"
    )
