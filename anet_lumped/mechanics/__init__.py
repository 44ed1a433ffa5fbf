"""Compiled mechanics of a net: what an integrator asks of it.

Force (`force`), the residual of an implicit stage and its Newton step (`residual`, `newton_step`), the energy account of a step
(`settle`), tensions and energies (`observe`), and the linear algebra (`linear`). `bindings` hands these functions to `integrators`
as a `System`.
"""
