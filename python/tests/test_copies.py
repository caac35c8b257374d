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


def test_models_and_rules_survive_a_pickle():
    rule = pickle.loads(pickle.dumps(cohelm.Rule("misc-r", kappa=0.25, median_range=2.0)))
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
