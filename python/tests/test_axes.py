"""Values of actions on axes: a critic that is trained here, asked what actions are worth, and flown with."""

import cohelm
import gymnasium
import numpy as np
import pytest

OPTIONS = {"actions": "continuous"}
SHORT = {"steps": 600, "warm_up": 200, "validations": 1, "validation_episodes": 2}


@pytest.fixture(scope="module")
def critic():
    return cohelm.train_values("flag-lander", options=OPTIONS, changes=SHORT)[0]


def test_it_says_what_actions_are_worth(critic):
    world = cohelm.World("flag-lander", '{"actions": "continuous"}')
    world.reset(3)
    actions = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, -0.9]], np.float32)
    worth = critic.assess(world, actions)
    assert worth.shape == (3,) and worth.dtype == np.float32 and len(set(worth)) == 3
    assert np.array_equal(critic.assess(world, actions[::-1]), worth[::-1])
    others = [critic.assess(world, actions, goal=goal) for goal in range(3)]
    assert np.array_equal(others[world.pilot_goal], worth)
    assert len({one.tobytes() for one in others}) == 3
    with pytest.raises(cohelm.OptionError, match="a goal from 0 to 2, got 3"):
        critic.assess(world, actions, goal=3)
    with pytest.raises(cohelm.ActionError, match=r"shape \(1, 2\)"):
        critic.assess(world, np.zeros((1, 3), np.float32))
    with pytest.raises(cohelm.ArrayError, match=r"rows of .* inputs, got 3"):
        critic.forward(np.zeros((1, 3), np.float32))
    with pytest.raises(cohelm.ArrayError, match=r"rows of .* inputs, got 3"):
        critic.embed(np.zeros((1, 3), np.float32))
    with pytest.raises(cohelm.ModelError, match="only a critic"):
        cohelm.shipped()["flag-lander-switches.values"].embed(np.zeros((1, 3), np.float32))
    with pytest.raises(cohelm.ModelError, match="does not fit"):
        critic.assess(cohelm.World("flag-lander"), np.zeros(1, np.int64))


def test_commands_are_assessed_by_what_the_network_says():
    values = cohelm.shipped()["flag-lander-main-side.values"]
    env = gymnasium.make("cohelm/SharedControl-v1", rule="hic", inference="known", actions="main-side").unwrapped
    env.reset(seed=1)
    commands = np.arange(len(env.world.commands))
    worth = values.assess(env.world, commands)
    assert np.array_equal(worth, env.step(env.nothing)[4]["values"])
    with pytest.raises(cohelm.ActionError, match="nothing has no value"):
        values.assess(env.world, commands + 1)


def test_it_flies_with_the_person_s_own_action_among_the_candidates(critic):
    env = gymnasium.make("cohelm/SharedControl-v1", rule="misc", inference="known", values=critic, **OPTIONS).unwrapped
    env.reset(seed=2)
    asked = np.array([0.25, -0.75], np.float32)
    for _ in range(20):
        tick = env.step(asked)[4]
        candidates = tick["candidates"]
        assert candidates.shape == (len(tick["values"]), 2) and len(tick["allowed"]) == len(candidates)
        assert (candidates == asked).all(axis=1).any()
        assert (candidates == tick["executed"]).all(axis=1).any()
        if tick["ending"]:
            break


def test_a_model_of_another_plant_is_refused_though_its_actions_and_state_are_alike():
    drones = cohelm.train_values("drone", options=OPTIONS, changes=SHORT)[0]
    drone, arm = (cohelm.World(plant, '{"actions": "continuous"}') for plant in ("drone", "arm"))
    for world in (drone, arm):
        world.reset(1)
    assert len(drone.state()) == len(arm.state()) and drone.axes == arm.axes
    actions = np.zeros((1, 2), np.float32)
    assert drones.assess(drone, actions).shape == (1,)
    with pytest.raises(cohelm.ModelError, match="trained for drone of version 1, and this is arm"):
        drones.assess(arm, actions)
    with pytest.raises(cohelm.ModelError, match="trained for drone"):
        gymnasium.make("cohelm/SharedControl-v1", plant="arm", rule="misc", inference="known", values=drones, **OPTIONS)
