"""Runs of scenes that differ in their numbers alone, on arrays that are made once: what a run takes beside its march is little."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anet_lumped.mechanics.renew_net import can_be_renewed, renew, renewable_net
from anet_lumped.model.build import build_anew
from anet_lumped.model.model import Model
from anet_lumped.results.run import Run, RunInterrupt
from anet_lumped.results.state import State
from anet_lumped.scene.origin import FAR, largest_distance, near_origin, places_given
from anet_lumped.scene.scene import Scene
from anet_lumped.statics.equilibrium import calm, equilibrium, rest_on
from anet_lumped.statics.starts import Start, start_state
from integrators import schemes
from integrators.linear_stability import NoLimit
from integrators.marching.fixed_steps import FixedSteps
from integrators.marching.march import March, Outcome

from .choice import Choice
from .legs import Settings
from .own_methods import look_every, net_and_system, run_of
from .plan import Asked, Plan, check_start, planned
from .times import Leg
from .verdict import judged


@dataclass
class Ready:
    """A run that is to be marched, or was: the state that it starts from, its plan, and how its march ended."""

    begin: State
    plan: Plan
    out: Outcome | None = None


class Repeated:
    """Runs of one scene after another; each gives what `simulate` gives, to the last bit.

    It serves one thread at a time.

    Parameters
    ----------
    asked : Asked
    start : as of `simulate`
    rho_inf : float or None
    """

    def __init__(self, asked: Asked, start: Start, rho_inf: float | None = None) -> None:
        self.asked, self.start, self.rho_inf = asked, start, rho_inf
        self.at_rest: Any = None
        self.planned: tuple[Any, Plan] | None = None
        self.last_model: tuple[Scene | None, Any] = None, None
        self.last_near: tuple[Scene | None, bool] = None, False
        self.last_points: tuple[Any, float] = None, 0.0  # points and bodies, and their largest coordinate [m]
        self.last_steps: tuple[tuple[float, float, str], tuple[FixedSteps, int]] | None = None
        self.marches: dict[str, tuple[Any, March]] = {}  # a net, and a march of it, by the method

    def serves(self, scene: Scene) -> bool:
        """Whether runs of a scene can be made here, as far as it alone tells: fixed steps to its end, without events."""
        given = self.asked.dt is not None and self.asked.rtol is None and self.asked.atol is None
        scheme = None if self.asked.method is None else schemes.scheme(self.asked.method)
        able = scheme is None or (scheme.own and not scheme.keeps_constraints)
        return given and able and not scene.events and self._is_near(scene) and can_be_renewed(self._model(scene))

    def _model(self, scene: Scene) -> Model:
        """`build` of a scene; `serves`, `begin` and `rest` ask in turn."""
        if self.last_model[0] is not scene:
            self.last_model = scene, build_anew(scene)
        model: Model = self.last_model[1]
        return model

    def _is_near(self, scene: Scene) -> bool:
        """Whether a scene is computed about its own origin; `serves` and `rest` ask in turn."""
        if self.last_near[0] is not scene:
            if self.last_points[0] is None or self.last_points[0] != (scene.points, scene.bodies):
                farthest = max((abs(x) for at in places_given(scene) for x in at), default=0.0)
                self.last_points = (scene.points, scene.bodies), farthest
            # what is no farther than that from the origin has its middle no farther from it
            surely = bool(scene.cables) and self.last_points[1] <= FAR * scene.longest
            self.last_near = scene, surely or near_origin(scene).scene is scene
        return self.last_near[1]

    def run(self, scene: Scene, begin: State | None = None) -> Run | None:
        """Run of a scene, in arrays that the next run overwrites; None if it has to be marched in another way.

        Parameters
        ----------
        scene : Scene
        begin : State or None, its rest, if that is known

        Raises
        ------
        InputError, EquilibriumError : as of `simulate`
        RunInterrupt : Ctrl-C
        """
        ready = self.prepare(scene, begin)
        if ready is None or not self.march(ready):
            return None
        return self.judge(ready)

    def prepare(self, scene: Scene, begin: State | None = None) -> "Ready | None":
        """State and plan of a run; None if it has to be marched in another way. Arguments and exceptions are those of `run`."""
        if not self.serves(scene):
            return None
        begin = self.begin(scene) if begin is None else begin
        plan = self.plan_of(scene, begin)
        scheme = schemes.scheme(plan.choice.method)
        if plan.adaptive or scheme.keeps_constraints or not scheme.own or plan.choice.dt != self.asked.dt:
            return None
        return Ready(begin, plan)

    def march(self, ready: "Ready", room: int = 0) -> bool:
        """March a run, whose rows go to arrays with a number; False if it has to be marched in another way."""
        march = self.march_of(ready.begin, ready.plan, room)
        if march is not None:
            ready.out = march.march(ready.begin.q, ready.begin.v)
        return march is not None

    def judge(self, ready: "Ready") -> Run:
        """Run that was marched, with its status, its warnings and the cause of its failure.

        Raises
        ------
        RunInterrupt : Ctrl-C
        """
        choice, out = ready.plan.choice, ready.out
        assert out is not None
        run = run_of(ready.begin.model, choice, out, Settings(False, (0.0, 0.0), self.rho_inf))
        if out.interrupted:
            raise RunInterrupt(run)
        return judged(run, choice.limit, False)

    def rooms(self, most: int, bytes_of_all: float) -> int:
        """Number of runs, up to ``most``, whose rows arrays of so many bytes hold; 1 before the first run."""
        kept = [sum(part.nbytes for part in march.saved) for _, march in self.marches.values()]
        return max(1, min(most, int(bytes_of_all / max(kept)))) if kept else 1

    def plan_of(self, scene: Scene, begin: State) -> Plan:
        """`planned`, which is the same for scenes with the same names and kinds of parts where method and step are given and the
        method is stable at any step."""
        names = begin.model.node_of  # which models share that are built one from another
        if self.planned is None or self.planned[0] is not names:
            plan = planned(scene, begin, self.asked)
            numbers_count = self.asked.method is None or not isinstance(schemes.scheme(self.asked.method).limit, NoLimit)
            self.planned = None if numbers_count else (names, plan)
            return plan
        check_start(scene, begin)
        return self.planned[1]

    def begin(self, scene: Scene) -> State:
        """State that a run of a scene starts from, as `first_state` gives it."""
        if isinstance(self.start, str) and self.start == "equilibrium":
            return self.rest(scene)
        if isinstance(self.start, str) and self.start == "calm":
            return replace(self.rest(calm(scene)), model=self._model(scene), residual=None, stable=None)
        return start_state(self._model(scene), self.start)

    def rest(self, scene: Scene) -> State:
        """`equilibrium` of a scene."""
        if not self._is_near(scene):
            return equilibrium(scene)
        model, found = self._model(scene), None
        if self.at_rest is None and can_be_renewed(model):
            self.at_rest = renewable_net(model, force=False, newton=False)
        if self.at_rest is not None and can_be_renewed(model) and renew(self.at_rest, model):
            found = rest_on(self.at_rest, model)
        return equilibrium(scene) if found is None else found

    def march_of(self, begin: State, plan: Plan, room: int = 0) -> March | None:
        """A march that is ready for a scene; None if its arrays are of other shapes than those of the first one."""
        model, choice = begin.model, plan.choice
        times, rows = self.steps(begin, choice)
        if choice.method not in self.marches:
            self.marches[choice.method] = self._made(model, choice.method, times, rows)
        net, march = self.marches[choice.method]
        if not (net.mass.shape == model.mass.shape and renew(net, model)):
            return None
        net.tension[:] = begin.segment_tension
        march.system.per_mass[:] = np.divide(1.0, model.mass, out=np.zeros(model.n), where=model.mass > 0.0)[:, None]
        march.system = march.system._replace(largest=largest_distance(model.scene))
        march.renew(times, room)
        return march

    def steps(self, begin: State, choice: Choice) -> tuple[FixedSteps, int]:
        """Times of the steps of a run from a state, and the largest number of states that it saves."""
        asked_now = begin.t, choice.dt, choice.method
        if self.last_steps is None or self.last_steps[0] != asked_now:
            leg = Leg(begin.t, begin.t + self.asked.t_end, begin.t, begin.t + self.asked.t_end, self.asked.save_every)
            stride, rows = leg.stride(choice.dt)
            looks = look_every(begin.scene, schemes.scheme(choice.method), stride)
            self.last_steps = asked_now, (FixedSteps(leg.begin, leg.end, choice.dt, leg.run_begin, stride, looks), rows)
        return self.last_steps[1]

    def _made(self, model: Model, method: str, times: FixedSteps, rows: int) -> tuple[Any, March]:
        scheme = schemes.scheme(method)
        needs = {"force": scheme.evaluates_force, "newton": not scheme.explicit}
        net, (_, bound) = renewable_net(model, **needs), net_and_system(model, scheme, np.zeros(model.n_segments))
        parameters = scheme.parameters(rho_inf=self.rho_inf)
        return net, March(scheme, bound, net.address, times, model.n, (rows, model.n_segments), parameters)
