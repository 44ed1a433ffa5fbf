"""The environment keeps Gymnasium's contract, and an action does what its docstring says."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Driven, InputError, load_scene, paths

pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env

from anet_lumped.flight.environment import NetEnv

NET = load_scene("net_carried")
EXTERNAL = replace(
    NET, points=[Driven(p.name, paths.external(p.path.at(0.0)[0])) if isinstance(p, Driven) else p for p in NET.points]
)


def height(session):
    return session.position("p0")[2]


def test_it_keeps_the_contract():
    check_env(NetEnv(EXTERNAL, height, duration=0.2), skip_render_check=True)


def test_an_action_is_a_velocity():
    env = NetEnv(EXTERNAL, height, dt=0.004, substeps=5, duration=0.1, speed=2.0)
    first, _ = env.reset(seed=1)
    action = np.zeros((4, 3))
    action[:, 2] = 0.25
    steps, cut = 0, False
    while not cut:
        found, reward, over, cut, info = env.step(action)
        steps += 1
    assert steps == 5 and not over and info["t"] == pytest.approx(0.1, abs=1e-12)
    places, speeds = found[: 3 * 5].reshape(5, 3), found[15:30].reshape(5, 3)
    assert speeds[:4] == pytest.approx(np.tile([0.0, 0.0, 0.5], (4, 1)), abs=1e-15)
    risen = places[:4, 2] - first[: 3 * 5].reshape(5, 3)[:4, 2]
    assert risen == pytest.approx(0.5 * (0.1 - 0.002), abs=1e-12)  # half a step is lost while the velocity is reached
    assert reward == places[4, 2] and env.names[4] == "p0" and (found[30:] > 0.1).all()
    again, _ = env.reset()
    assert np.array_equal(again, first)


@pytest.mark.filterwarnings("ignore:.*beyond the largest stable step")
def test_a_failed_step_ends_the_episode_and_messages():
    env = NetEnv(EXTERNAL, height, method="verlet", dt=1e-3, speed=100.0, duration=10.0)
    env.reset()
    over, k = False, 0
    with np.errstate(all="ignore"):
        while not over and k < 2000:
            k += 1
            found, _, over, _, info = env.step(np.full((4, 3), (-1.0) ** k))
    assert over and "diverged" in info["failed"] and np.isfinite(found).all()
    with pytest.raises(InputError, match=r"at least one point whose path is paths\.external"):
        NetEnv(NET, height)
    with pytest.raises(InputError, match="`substeps` must be positive and finite, but it is 0"):
        NetEnv(EXTERNAL, height, substeps=0)
