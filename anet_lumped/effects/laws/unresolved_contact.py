"""The numerical damper of a contact that a step does not resolve.

A body rests on a spring. If it swings on the spring faster than the step resolves, the midpoint rule lets it swing from step to
step for ever. The damper adds the part 2 alpha of the change of depth over the step to the depth at which the contact force is
taken,

    alpha = damper s^4/(1 + s^4) ,   s = omega h/2 ,   omega^2 = k/m .

With ``damper`` = 1/2 and a very long step, 2 alpha = 1 and the force is the force at the depth at the end of the step. alpha is of
fourth order in the step: where the step resolves the contact, a body that swings on it loses 2 pi s^5 of its energy in a period.
The damper acts on contacts that last, whose body is in touch at the start of the step. A body that touches down within a step keeps
its energy.

Then the depth is at rest, and yet the velocity v_b = 2 (q_b - q_a)/h - v_a changes its sign from step to step for ever. As with
cables (`mechanics.settle`), an impulse along the contact takes the part 2 alpha of the difference between the rate of the depth at
the end of the step and its mean rate over the step. The impulse can only take energy. Source: after Armero & Petocz, Comput.
Methods Appl. Mech. Engrg. 158 (1998) 269, who damp all of a contact.
"""

from anet_lumped.compiled.jit import inlined_law


@inlined_law
def numerical_share(damper, square):
    """alpha of the module's docstring for ``square`` = (omega h/2)^2."""
    fourth = square * square
    return damper * fourth / (1.0 + fourth)


@inlined_law
def settled_rate(damper, square, rate, mean):
    """Rate of a depth at the end of a step, without the part of it that rings about ``mean``, the mean rate over the step."""
    wanted = 2.0 * numerical_share(damper, square) * (rate - mean)
    if wanted * rate <= 0.0:
        return rate
    return 0.0 if abs(wanted) > abs(rate) else rate - wanted
