"""Every plant that is registered is an environment: checked, drawn, flown by a person who is simulated."""

import warnings

import cohelm
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

PLANTS = ["flag-lander", "drone", "arm"]


def test_the_plants_are_those_of_the_program():
    assert set(PLANTS) <= set(cohelm.plants())
    assert all(summary.endswith(".") for summary in cohelm.plants().values())


@pytest.mark.parametrize("plant", sorted(cohelm.plants()))
def test_gymnasium_s_check_passes(plant):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # The numbers of a state have no bounds that could not be crossed for a tick.
        warnings.filterwarnings("ignore", message=".*(minimum|maximum) value is .*infinity")
        check_env(gymnasium.make("cohelm/PlantTask-v1", plant=plant, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("plant", PLANTS)
def test_somebody_steers_it_and_it_is_drawn(plant):
    env = gymnasium.make("cohelm/PlantTask-v1", plant=plant, render_mode="rgb_array").unwrapped
    pilot = cohelm.SimulatedPilot(env.world)
    endings = []
    for seed in range(6):
        env.reset(seed=seed)
        pilot.reset(seed)
        first, tick = env.render(), {"ending": None}
        while tick["ending"] is None:
            asked = pilot.ask(env.world)
            *_, tick = env.step(env.nothing if asked is None else asked)
        endings.append(tick["ending"])
        assert pilot.key_presses > 1
        picture = env.render()
        assert picture.shape == first.shape and len(np.unique(first.reshape(-1, 3), axis=0)) > 5
        assert not np.array_equal(first, picture)
    assert set(endings) <= {"goal", "crash", "out-of-bounds", "elsewhere", "time-limit"}


def test_a_plant_that_is_not_there_is_refused_in_words():
    with pytest.raises(cohelm.OptionError, match='no plant is called "rowing-boat"'):
        gymnasium.make("cohelm/PlantTask-v1", plant="rowing-boat")
