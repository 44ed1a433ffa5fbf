"""Cables that do not stretch as chains of links: tensions from the constraint on accelerations, and lengths that are kept.

Each link l joins the nodes a and b, d = q_b - q_a, and keeps its length L(t):

    d . (a_b - a_a) = -|v_b - v_a|^2 + L L'' + L'^2 .

With a_i = W_i (f_i + sum of +- tau d), W the inverse of the mass of a node with the fluid that it carries and tau a tension
over its length, that is a linear system S tau = r with one unknown a link: S_lk = +- d_l . W d_k for links that share a moving
node. It is symmetric, and positive definite unless constraints are redundant. `elimination` solves it, `bodies` has the mobility
of rigid bodies, whose nodes move as one piece, `motion` has what an integrator asks for, `project` gives lengths and their rates
back after a step.

Source: Hairer, Lubich & Roche, The Numerical Solution of Differential-Algebraic Systems by Runge-Kutta Methods (1989), section 1;
Hairer & Wanner, Solving Ordinary Differential Equations II (1996), VII.2 (projection).
"""
