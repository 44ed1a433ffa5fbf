"""The answer of the study `measured` in words."""

import numpy as np

from studies.questions.measured import flights, hanging, lindahl
from studies.questions.measured.tables import FINER, FINEST, FIT_PERIOD, FITTED_STEPS, GIVEN, TUNED, TUNED_FINER
from studies.shown.sentences import counted, listed, percent
from studies.shown.show import as_text

SLOW, FAST = lindahl.PERIODS
FITTED_NUMBERS = {"distance": ("the distance of the driven end", "m"), "Cdn": ("the drag coefficient across", "")}


def answer(rows):
    """The answer, every number and every claim from `rows`."""
    return "\n\n".join([*_chain(rows), _hanging(rows["hanging"]), _flights(rows["flights"]), _left_out(rows["flights"])])


def _chain(rows):
    chain, sensitivity = rows["chain"].set_index(["setting", "period_s"]), rows["sensitivity"]
    bad = rows["chain"]["status"] != "done"
    yield (
        f"A chain that goes slack and snaps: with the coefficients given its tension is {_beside(chain.loc[(GIVEN, SLOW)])} at "
        f"{SLOW:g} s and {_beside(chain.loc[(GIVEN, FAST)])} at {FAST:g} s. The experiment itself scatters by "
        f"{lindahl.SCATTER[SLOW]:g} and {lindahl.SCATTER[FAST]:g} N from cycle to cycle."
        + f" {counted(bad.sum(), 'run')} did not end well."
        * bool(bad.any())
    )
    numbers = []
    for line in rows["fitted"].itertuples():
        what, unit = FITTED_NUMBERS[line.number]
        numbers.append(f"{what} from {line.given:.5g} to {line.fitted:.5g} ± {line.standard_error:.1g} {unit}".rstrip())
    yield (
        f"What a fit to the slower motion alone may change: {listed(numbers)}. The tension is then "
        f"{_beside(chain.loc[(TUNED, SLOW)])} at {SLOW:g} s and {_beside(chain.loc[(TUNED, FAST)])} at {FAST:g} s, which nothing "
        "was fitted to."
    )
    if (FINER, FAST) in chain.index:
        yield (
            f"With {FINEST['segments']} segments and {FINEST['steps']} steps of a period in place of {lindahl.Chain.segments} and "
            f"{lindahl.Chain.steps}, the faster motion is {_beside(chain.loc[(FINER, FAST)])} as given, and "
            f"{_beside(chain.loc[(TUNED_FINER, FAST)])} as fitted anew."
        )
    given, other = chain.loc[(GIVEN, FAST)], chain.loc[("MoorDyn 2.7.2", FAST)]
    yield (
        "The rest belongs to the model and its coefficients, not to the library: MoorDyn, an independent code, has an rms error of "
        f"{other.rms_N:.2f} N, a peak of {other.peak_N:.1f} N and a mean of {other.mean_N:.2f} N at {FAST:g} s, where this library "
        f"has {given.rms_N:.2f}, {given.peak_N:.1f} and {given.mean_N:.2f} N. Where the slack is taken up, at phases 0.36 to 0.44, "
        f"the model carries {given.taken_up_N:.1f} N and the chain carried {given.taken_up_measured_N:.1f} N. "
        + _cause(sensitivity, given)
    )


def _beside(line):
    peak, mean = line.peak_error_percent, line.mean_error_percent
    return f"off by {line.rms_N:.2f} N rms, {peak:+.1f} % in its peak and {mean:+.1f} % in its mean"


def _cause(sensitivity, given):
    """Which numbers change the tension where slack is taken up, and which do not."""
    fast = sensitivity[(sensitivity["period_s"] == FAST) & (sensitivity["status"] == "done")].copy()
    fast["change"] = fast["taken_up_N"] - given.taken_up_N
    fast["nearer"] = -fast["change"] / (given.taken_up_N - given.taken_up_measured_N)
    nearer = fast[fast["nearer"] > 0.25]
    low = [name for name in dict.fromkeys(fast["number"]) if fast.loc[fast["number"] == name, "nearer"].abs().max() < 0.1]
    told = []
    if len(nearer):
        ways = [
            f"{line.number.replace('_', ' ')} = {line.value.strip(chr(34))} ({line.taken_up_N:.1f} N, rms {line.rms_N:.2f} N)"
            for line in nearer.itertuples()
        ]
        told.append(f"A quarter of that or more is taken off by {listed(ways)}.")
    if low:
        told.append(f"Less than a tenth of it changes with {listed(name.replace('_', ' ') for name in low)}.")
    return " ".join(told)


def _hanging(table):
    lines = table.set_index("code")
    exact, own = lines.loc[hanging.EXACT], lines[lines.index.str.startswith("this library")].iloc[-1]
    far = (lines.loc[list(hanging.PUBLISHED)] / exact - 1.0).abs().max(axis=1)
    return (
        f"A hanging cable in water: the elastic catenary gives {_three(exact)} kN at the top, at the bottom and along the level, "
        f"this library {_three(own)} kN ({own.name.split(', ')[1]}). Published numbers differ from that by up to "
        f"{listed(f'{percent(share)} ({code})' for code, share in far.items())}."
    )


def _three(line):
    return listed(f"{line[name]:.3f}" for name in ("top_kN", "bottom_kN", "horizontal_kN"))


def _flights(table):
    if not len(table):
        return (
            "Measured flights: skipped, because no folder of them was given; anet-lumped study measured --data FOLDER takes it, "
            "and the public logs are in IMRCLab/col-trans on GitHub."
        )
    told = []
    for kind, part in table.groupby("kind", sort=True):
        held = part[part["half"] == flights.HELD]
        told.append(
            f"{kind}: {_rms(part['model_rms_mm'])} mm, and {_rms(held['model_rms_mm'])} mm in the "
            f"{counted(len(held), 'flight')} held back, where a guess that has it rest at each moment is off by "
            f"{_rms(part['guess_rms_mm'])} and {_rms(held['guess_rms_mm'])} mm"
        )
    return (
        f"The payload of {counted(len(table), 'measured flight')}, driven by the drones' measured places, with one number fitted "
        f"on half of them, a decay rate of {as_text(float(table['damping_per_s'].iloc[0]))} 1/s: {'; '.join(told)}."
    )


def _rms(values):
    return f"{np.sqrt(np.mean(np.square(values))) if len(values) else np.nan:.1f}"


def _left_out(table):
    left = f", and the flight {listed(name.replace('_', ' ') for name in flights.LEFT_OUT)}, whose two logs are badly aligned"
    return (
        f"Left out: a fit to the faster motion. Of the numbers fitted at {FIT_PERIOD:g} s there are {len(FITTED_STEPS)}; the drag "
        "along the chain is not among them, because the slower motion hardly depends on it" + left * bool(len(table)) + "."
    )
