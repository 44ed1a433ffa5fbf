"""What a notebook shows of states and runs."""

import base64
import re

from systems import four_cables, loose_cable

from anet_lumped import equilibrium, simulate


def picture(html):
    (data,) = re.findall(r"data:image/png;base64,([^']+)'", html)
    return base64.b64decode(data)


def test_a_rest():
    rest = equilibrium(four_cables())
    html = rest._repr_html_()
    assert "<th style='text-align:left'>stable</th><td style='text-align:left'>yes</td>" in html
    assert f"{rest.tension('s0-p0').max():.4g} N" in html and picture(html).startswith(b"\x89PNG")


def test_a_run_tells_its_peak_and_its_warnings():
    run = simulate(loose_cable(1e4), 0.3, method="edmc", dt=0.01, start="straight")
    html = run._repr_html_()
    assert f"{run.segment_tension.max():.4g} N in " in html and "done" in html and picture(html).startswith(b"\x89PNG")
    assert html.count("<b>Warning:</b>") == len(run.warnings)


def test_names_are_no_markup():
    scene = four_cables()
    run = simulate(scene, 0.02, method="edmc", dt=0.01)
    assert "&#x27;done&#x27;" in run._repr_html_()  # the apostrophes of its repr
