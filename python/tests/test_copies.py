"""Snapshots go on with the same bits, with a co-pilot in the world too; pickles are fresh, as Gymnasium's are."""

import copy
import pickle

import cohelm
import gymnasium
import numpy as np
import pytest

ENVS = [
    ("cohelm/LunarLander-v3", {}),
    ("cohelm/FlagLander-v1", {"actions": "main-side"}),
    ("cohelm/SharedControl-v1", {"rule": "misc", "inference": "softmax"}),
]


def flight(env, steps=60):
    """Observations and rewards from here on, across an end of an episode if there is one."""
    seen = []
    for step in range(steps):
        observation, reward, terminated, truncated, _ = env.step(step % 4)
        seen.append((observation.tobytes(), reward))
        if terminated or truncated:
            seen.append(env.reset()[0].tobytes())
    return seen


@pytest.mark.parametrize("name, options", ENVS)
def test_what_is_restored_or_copied_goes_on_with_the_same_bits(name, options):
    env = gymnasium.make(name, **options).unwrapped
    env.reset(seed=3)
    flight(env, 40)
    kept, copied = env.snapshot(), copy.deepcopy(env)
    ahead = flight(env, 300)
    env.restore(kept)
    assert flight(env, 300) == ahead
    env.restore(kept)
    assert flight(env, 10) == ahead[:10]
    assert flight(copied, 300) == ahead


@pytest.mark.parametrize("name, options", ENVS)
def test_a_pickle_is_a_fresh_environment_with_the_same_arguments(name, options):
    env = gymnasium.make(name, **options).unwrapped
    again = pickle.loads(pickle.dumps(env))
    assert np.array_equal(env.reset(seed=5)[0], again.reset(seed=5)[0])
    assert flight(env) == flight(again)


@pytest.mark.parametrize("options", [{}, {"continuous": True}, {"enable_wind": True, "gravity": -7.0}])
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda lander: pickle.loads(pickle.dumps(lander))])
def test_a_copied_lander_goes_on_with_the_same_bits(options, copied):
    rng = np.random.default_rng(0)

    def act():
        return rng.uniform(-1.2, 1.2, 2).astype(np.float32) if options.get("continuous") else int(rng.integers(4))

    def ahead(lander):
        flown = [lander.step(action) for action in actions] + [lander.reset(), lander.step(actions[0])]
        return [repr((one[0].tobytes(), one[1:])) for one in flown], lander.ticks

    lander = cohelm.Lander(**options)
    fresh = copied(lander)
    with pytest.raises(cohelm.ClosedError, match="no episode has begun"):
        fresh.step(act())
    lander.reset(4)
    for _ in range(130):
        lander.step(act())
    # The episode after the seed's: what came before it is not flown again.
    lander.reset()
    for _ in range(50):
        lander.step(act())
    actions = [act() for _ in range(200)]
    again = copied(lander)
    assert again.ticks == lander.ticks == 50
    assert np.array_equal(again.render(), lander.render())
    assert ahead(again) == ahead(lander)


WORLDS = [
    ("flag-lander", "{}", {}),
    ("flag-lander", '{"actions": "continuous"}', {}),
    ("flag-lander", "{}", {"rule": "misc", "inference": "softmax", "silence": "nothing"}),
    ("drone", "{}", {}),
    ("arm", "{}", {}),
]


@pytest.mark.parametrize("plant, options, help_", WORLDS)
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda world: pickle.loads(pickle.dumps(world))])
def test_a_copied_world_goes_on_with_the_same_bits(plant, options, help_, copied):
    if help_:
        shipped = cohelm.shipped()
        models = {"values": "flag-lander-switches.values", "intent": "flag-lander-switches.intent"}
        help_ = {**help_, **{name: shipped[model] for name, model in models.items()}}
        help_["rule"] = cohelm.Rule(help_["rule"]).native
    world = cohelm.World(plant, options, **help_)
    with pytest.raises(cohelm.ClosedError, match="no episode has begun"):
        copied(world).step()
    world.reset(8)

    def asked(step):
        if step % 3 == 2:
            return None
        return np.array([0.3, -0.7], np.float32) if world.axes else step % len(world.commands)

    for step in range(20):
        world.step(asked(step))
    again = copied(world)
    for step in range(20, 40):
        told, heard = world.step(asked(step)), again.step(asked(step))
        assert told.keys() == heard.keys()
        assert all(np.array_equal(told[name], heard[name]) for name in told)
        assert world.state().tobytes() == again.state().tobytes() and world.ticks == again.ticks


def test_a_copied_pilot_is_the_same_person_before_an_episode():
    world = cohelm.World("flag-lander")
    pilot = cohelm.SimulatedPilot(world, population="slow", seed=3, index=2)
    pilot.reset(1)
    for copied in (copy.copy(pilot), copy.deepcopy(pilot), pickle.loads(pickle.dumps(pilot))):
        with pytest.raises(cohelm.ClosedError, match="call reset"):
            copied.ask(world)
        flights = []
        for person in (pilot, copied):
            world.reset(5)
            person.reset(5)
            flight, ending = [], None
            while ending is None:
                flight.append(person.ask(world))
                ending = world.step(flight[-1])["ending"]
            flights.append((flight, person.key_presses))
        assert flights[0] == flights[1] and flights[0][1] > 1


def test_a_wrapped_environment_is_copied_too():
    env = gymnasium.make("cohelm/SharedControl-v1", rule="misc-r")
    env.reset(seed=2)
    flight(env, 20)
    assert flight(copy.deepcopy(env), 40) == flight(env, 40)


def test_models_and_rules_survive_a_pickle():
    rule = pickle.loads(pickle.dumps(cohelm.Rule("misc-r", kappa=0.25, median_range=2.0)))
    assert repr(rule) == repr(copy.deepcopy(rule)) == repr(pickle.loads(pickle.dumps(rule.native)))
    assert repr(rule) == "Rule('misc-r', kappa=0.25)"
    assert rule.decide([0.0, 0.4, 1.0], 0.5, asked=1) == 2 and rule.decide([0.0, 0.6, 1.0], 0.5, asked=1) == 1
    for model in cohelm.shipped().values():
        assert pickle.loads(pickle.dumps(model)).hash == model.hash
    rng = np.random.default_rng(0)
    layers = [(rng.normal(size=(3, 5)).astype(np.float32), rng.normal(size=3).astype(np.float32))]
    critic = cohelm.ValueModel.from_layers(layers)
    inputs = rng.normal(size=(4, 5)).astype(np.float32)
    assert np.array_equal(pickle.loads(pickle.dumps(critic)).forward(inputs), critic.forward(inputs))


def test_a_file_of_another_kind_is_refused_in_words():
    values = cohelm.shipped()["flag-lander-switches.values"]
    with pytest.raises(cohelm.ModelError, match="a model for intent is needed"):
        cohelm.IntentModel.from_bytes(values.to_bytes())
    with pytest.raises(cohelm.ModelError, match="no model"):
        cohelm.ValueModel.from_bytes(b"nothing")
