"""Words of the study `length_error`."""

import numpy as np

from studies.questions.length_error.stretch import FLOOR_STEPS, SPANS, STEPS, THESIS_STRETCH, shown_segments
from studies.shown.sentences import between, listed, power, share
from studies.shown.show import as_text
from studies.thesis_cable import CORD_EA, GRAVITY, MASS

LEFT_OUT = (
    "Left out: the thesis states neither its solver nor its step, so that the floor is an inference from three symptoms that it "
    "does state. Its rigid links are another matter: twenty joints of 5 mm between links of 5 cm make 1.10 m as well. The sag's "
    "error is given at even N, where a node is at the lowest point. Bending, and cords whose EA changes with tension, are not in "
    "the model."
)


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    return "\n\n".join([
        _finding(rows), _springs(rows["springs"]), _shape(rows["shape"], rows["refinement"]), _floor(rows["floor"]),
        _cure(rows["floor"], rows["cure"]), LEFT_OUT,
    ])  # fmt: skip


def _least_stretch(floors):
    """Least stretch [%] of the hung cable by scheme and step, at the thesis's number of segments."""
    hung = floors[floors["arrangement"] == "hung"]
    hung = hung[hung["segments"] == shown_segments(hung)]
    return {(row.scheme, row.dt_s): 100 * row.floor_measured for row in hung.itertuples()}


def _finding(rows):
    hung, floors, edmc = rows["springs"].set_index("arrangement").loc["hung"], _least_stretch(rows["floor"]), rows["cure"]
    cord = 100 * MASS * GRAVITY / (2 * CORD_EA)
    edmc = edmc[(edmc["scheme"] == "edmc") & (edmc["ended"] == "done")]
    below = 100 * edmc["stretch_at_rest"] < edmc["dt_s"].map(lambda dt: floors["rk4", dt])
    enforced = floors["rk4", 1e-2] > 0.5 * 100 * THESIS_STRETCH
    return (
        f"The lumped model does not make a cable long: at the stiffness of a cord ({power(CORD_EA)} N) a cable that hangs "
        f"stretches by {as_text(cord, 2)} %. The thesis's 1.1 m is that of springs {power(hung.cord_is_stiffer_by, 2)} times too "
        f"soft"
        + (", and such springs are what an explicit step of about 10 ms enforces" if enforced else "")
        + f": at 10 ms {shown_segments(rows['floor'])} segments leave no stretch below {floors['rk4', 1e-2]:.1f} % (RK4) or "
        f"{floors['symplectic_euler', 1e-2]:.1f} % (symplectic Euler), whatever the cable is made of. The implicit edmc "
        + (f"has no such floor: {share(below.sum(), len(edmc))} of its runs stretched less at rest than RK4 permits." if below.any()
           else "did not get below it either.")
    )  # fmt: skip


def _springs(table):
    table = table.set_index("arrangement")
    hung, two = table.loc["hung"], table.loc["two cables"]
    spans = listed(f"{table.loc[name, 'spring_N_per_m']:.1f}" for name in SPANS)
    off = 100 * (table["catenary_EA_N"] / table["EA_N"] - 1).abs().max()
    return (
        f"Springs that make 1.1 m (20 segments, 100 g): {hung.spring_N_per_m:.1f} N/m hung from one end, {spans} N/m between "
        f"supports {listed(f'{span}' for span in SPANS.values())} m apart, {two.spring_N_per_m:.1f} N/m for two cables that meet: "
        f"EA = {between(table['EA_N'], 'N', 2)}. If the loose end carries the mass of a whole segment instead of a half, as twenty "
        f"equal masses have it, {hung.spring_full_end_mass_N_per_m:.1f} N/m hung and {two.spring_full_end_mass_N_per_m:.1f} N/m "
        f"for the two cables. The elastic catenary needs the same EA within {as_text(off, 2)} %"
        + (", so that the length is the spring's and not the segments'" if off < 1.0 else "")
        + f". RK4 is stable with these springs up to {between(table['rk4_step_ms'], 'ms')}, symplectic Euler up to "
        f"{between(table['symplectic_euler_step_ms'], 'ms')}."
    )


def _shape(shapes, refined):
    between_supports = shapes[shapes["arrangement"] == "0.8 m apart"]
    stiff = between_supports[between_supports["EA_N"] == between_supports["EA_N"].max()]
    soft = between_supports[between_supports["EA_N"] == between_supports["EA_N"].min()]
    sag = listed(f"{as_text(row.sag_error_mm, 3)} mm with {row.segments:.0f}" for row in refined.itertuples())
    half, full = (_slope(refined["segments"], refined[f"swing_error_{end}_end_mass_percent"]) for end in ("half", "full"))
    ends = f"{stiff['segments'].iloc[0]} and {stiff['segments'].iloc[-1]}"
    return (
        f"Between supports 0.8 m apart the nodes of {ends} segments are {as_text(stiff['rmse_elastic_mm'].iloc[0], 2)} and "
        f"{as_text(stiff['rmse_elastic_mm'].iloc[-1], 2)} mm (RMSE) from the elastic catenary at EA = "
        f"{power(stiff['EA_N'].iloc[0])} N, and {as_text(soft['rmse_elastic_mm'].iloc[0], 2)} and "
        f"{as_text(soft['rmse_elastic_mm'].iloc[-1], 2)} mm at EA = {power(soft['EA_N'].iloc[0])} N. From the catenary that does "
        f"not stretch they are {between(soft['rmse_inextensible_mm'], 'mm', 2)} at the lowest stiffness and "
        f"{between(stiff['rmse_inextensible_mm'], 'mm', 2)} at the highest. The error of the sag is {sag} segments; it falls as N "
        f"to the power {_slope(refined['segments'], refined['sag_error_mm']):.2f}. The first frequency of the hung cable converges "
        f"as N to the power {half:.2f} with half a segment's mass at its loose end, and {full:.2f} with a whole one."
    )


def _floor(floors):
    hung = floors[floors["arrangement"] == "hung"]
    off = 100 * (hung["floor_measured"] / hung["floor_closed_form"] - 1).abs().groupby(hung["segments"]).max()
    exact_off = 100 * (floors["floor_measured"] / floors["floor_predicted"] - 1).abs().max()
    least = _least_stretch(floors)
    joined = floors[(floors["arrangement"] == "two cables") & (floors["scheme"] == "rk4")].set_index("dt_s")
    growth = hung[(hung["scheme"] == "rk4") & (hung["dt_s"] == STEPS[0])]
    return (
        "The floor: an explicit step dt is stable while dt omega ≤ S, so that EA cannot exceed a bound, and the mean stretch of a "
        "hung cable cannot fall below eps = 2 g N² dt²/(S² L), S = 2 (symplectic Euler) or 2.83 (RK4); mass and material have "
        "dropped out. EA was raised until the energy of a disturbance of 1e-10 of m g L grew a thousandfold within "
        f"{FLOOR_STEPS} steps. The closed form, which takes the top frequency as that of an endless chain, is right within "
        f"{as_text(off.iloc[0], 2)} % with {off.index[0]} segments and {as_text(off.iloc[-1], 2)} % with {off.index[-1]}; with the "
        f"exact frequency, and for cables between supports too, prediction and measurement agree within {as_text(exact_off, 2)} %. "
        f"It grows as N to the power {_slope(growth['segments'], growth['floor_measured']):.2f}: what refinement gains in shape it "
        f"loses in stretch. At 1 ms it is {least['rk4', 1e-3]:.3f} % (RK4) and {least['symplectic_euler', 1e-3]:.3f} %; for the "
        f"two cables that meet, at 10 ms with RK4, {100 * joined.loc[1e-2, 'floor_measured']:.1f} %."
    )


def _cure(floors, cured):
    least = _least_stretch(floors)
    edmc, rk4 = cured[cured["scheme"] == "edmc"], cured[cured["scheme"] == "rk4"]
    stiff = edmc[edmc["EA_N"] == edmc["EA_N"].max()]
    below = 100 * rk4["stretch_at_rest"] < rk4["dt_s"].map(lambda dt: least["rk4", dt])
    lost, rise = rk4["ended"] == "diverged", max(edmc["energy_rise"].max(), 0.0)
    energy = f"the largest rise of energy is {power(rise, 1)} of that of the swing" if rise > 0.0 else "the energy rises in none"
    fates = [
        f"{share(lost[some].sum(), some.sum())} {where}"
        for some, where in ((below, "below it"), (~below, "above it")) if some.any()
    ]  # fmt: skip
    return (
        f"The cure: edmc swung the same cable (1 rad/s at first, 2 s) at steps of {between(1e3 * edmc['dt_s'], 'ms')} with EA up "
        f"to {power(edmc['EA_N'].max())} N, where the largest stretch is {power(100 * stiff['largest_stretch'].max(), 2)} %; "
        f"{share((edmc['ended'] == 'done').sum(), len(edmc))} runs reached their end, with "
        f"{between(edmc['newton_per_step'], '', 2)} Newton iterations a step, and {energy}. Of RK4's {len(rk4)} runs at the "
        f"same steps and stiffnesses {int(below.sum())} are below its floor; {listed(fates)} diverged."
    )


def _slope(x, y):
    return np.polyfit(np.log(x), np.log(y), 1)[0]
