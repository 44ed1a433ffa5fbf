"""Compiled mechanics of a net: what an integrator asks of it.

Force (`force`), the residual of an implicit stage and its Newton step (`residual`, `newton_step`), the account of a step
(`settle`), what is saved (`observe`), and the linear algebra (`linear`). `bindings` hands all of it to `integrators` as a `System`.
"""
