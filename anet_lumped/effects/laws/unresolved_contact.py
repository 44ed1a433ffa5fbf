"""The numerical damper of a contact that a step does not resolve.

A body that rests on a spring which is over within a step swings on it from step to step for ever, as the midpoint rule has it. The
damper takes the part

    2 alpha ,   alpha = damper s^4/(1 + s^4) ,   s = omega h/2 ,   omega^2 = k/m ,

of the change of depth over a step for an additional depth, so that with ``damper`` = 1/2 and a step that is too long the force is
that of the depth at the end of the step. It sets in with the fourth power of the step and is not felt where the step resolves the
contact: of a body that swings on it, it takes 2 pi s^5 of the energy in a period. It acts on contacts that last, whose body is in
touch at the start of the step: what touches down within a step keeps its energy.

The depth is then at rest, and yet v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to step for ever. As with cables
(`mechanics.settle`), an impulse along the contact takes the same part, 2 alpha, of what the rate of the depth differs from that
over the step; it only takes energy.
Source: after Armero & Petocz, Comput. Methods Appl. Mech. Engrg. 158 (1998) 269, who damp all of a contact.
"""

from anet_lumped.compiled.jit import njit


@njit(cache=True, error_model="numpy", forceinline=True)
def numerical_share(damper, square):
    """alpha of the module's docstring for ``square`` = (omega h/2)^2."""
    fourth = square * square
    return damper * fourth / (1.0 + fourth)


@njit(cache=True, error_model="numpy", forceinline=True)
def settled_rate(damper, square, rate, mean):
    """Rate of a depth at the end of a step without what rings about ``mean``, its rate over the step."""
    wanted = 2.0 * numerical_share(damper, square) * (rate - mean)
    if wanted * rate <= 0.0:
        return rate
    return 0.0 if abs(wanted) > abs(rate) else rate - wanted
