"""diffrax's solvers as schemes; what marches them is `diffrax_adapter`, which alone imports JAX."""

from integrators.linear_stability import AmplificationPolynomial, NoLimit

from .record import Family, Origin, Scheme, Stepping

TSIT5_Z6 = 0.0014322113248073478  # coefficient of z^6 in its R(z), from its tableau; the lower ones are those of exp(z)

TSIT5 = Scheme(
    name="Tsit5",
    label="diffrax Tsit5",
    origin=Origin.DIFFRAX,
    family=Family.EXPLICIT_RUNGE_KUTTA,
    order=5,
    explicit=True,
    limit=AmplificationPolynomial(lambda: (1.0, 1.0, 1 / 2, 1 / 6, 1 / 24, 1 / 120, TSIT5_Z6)),
    note="adaptive: the step that error control is driven to; undamped modes only to h omega = 0.478",
    stepping=Stepping.ADAPTIVE,
    stops_at_events=False,
)
KVAERNO3 = Scheme(
    name="Kvaerno3",
    label="diffrax Kvaerno3",
    origin=Origin.DIFFRAX,
    family=Family.DIAGONALLY_IMPLICIT,
    order=3,
    explicit=False,
    limit=NoLimit(),
    note="stable for small motion (L-stable), adaptive; may gain energy when slack, from its explicit first stage",
    stepping=Stepping.ADAPTIVE,
    stops_at_events=False,
)
KVAERNO5 = Scheme(
    name="Kvaerno5",
    label="diffrax Kvaerno5",
    origin=Origin.DIFFRAX,
    family=Family.DIAGONALLY_IMPLICIT,
    order=5,
    explicit=False,
    limit=NoLimit(),
    note="stable for small motion (L-stable), adaptive; may gain energy when slack, from its explicit first stage",
    stepping=Stepping.ADAPTIVE,
    stops_at_events=False,
)
