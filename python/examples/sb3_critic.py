"""Somebody else's critic: a DQN of Stable-Baselines3 is trained on the flag task, and MISC flies with its values."""

import argparse

import cohelm
import gymnasium
import numpy as np
from cohelm.envs import CriticView
from stable_baselines3 import DQN

TASK = {"actions": "main-side"}


def train(steps, demonstrations=150, seed=0):
    """A DQN that sees the state and the own goal, and chooses commands. It first watches a hand-made controller fly."""
    env = CriticView(gymnasium.make("cohelm/FlagLander-v1", **TASK))
    dqn = DQN(
        "MlpPolicy",
        env,
        learning_rate=lambda left: 5e-5 + 9.5e-4 * left,
        gamma=0.995,
        n_steps=5,
        batch_size=128,
        buffer_size=200_000,
        learning_starts=1_000,
        train_freq=4,
        gradient_steps=2,
        tau=0.005,
        target_update_interval=1,
        exploration_initial_eps=0.2,
        exploration_fraction=0.5,
        exploration_final_eps=0.02,
        policy_kwargs={"net_arch": [64, 64]},
        seed=seed,
        device="cpu",
    )
    watch(dqn, env, demonstrations, seed)
    return dqn.learn(steps)


def watch(dqn, env, episodes, seed, wrong=0.1):
    """Puts flights of the hand-made controller, with a share of wrong commands, into what the DQN learns from."""
    world, draws = env.unwrapped.world, np.random.default_rng(seed)
    for episode in range(episodes):
        seen, _ = env.reset(seed=1_000_000 + episode)
        over = False
        while not over:
            command = world.teacher()
            if command is None or draws.uniform() < wrong:
                command = int(draws.integers(env.action_space.n))
            then, reward, terminated, truncated, _ = env.step(command)
            over = terminated or truncated
            dqn.replay_buffer.add(seen, then, np.array([command]), np.array([reward]), np.array([terminated]), [{}])
            seen = then


def critic_of(dqn):
    """Its Q-network as a value model: weights and biases of its dense layers."""
    dense = [layer for layer in dqn.q_net.q_net if hasattr(layer, "weight")]
    return cohelm.ValueModel.from_layers(
        [(layer.weight.detach().numpy().copy(), layer.bias.detach().numpy().copy()) for layer in dense]
    )


def fly(values, rule, episodes, **options):
    """Shares of endings of a simulated pilot's episodes under a rule."""
    env = gymnasium.make("cohelm/SharedControl-v1", rule=rule, values=values, **TASK, **options).unwrapped
    pilot = cohelm.SimulatedPilot(env.world)
    endings = []
    for seed in range(episodes):
        env.reset(seed=seed)
        pilot.reset(seed)
        tick = {"ending": None}
        while tick["ending"] is None:
            asked = pilot.ask(env.world)
            *_, tick = env.step(env.nothing if asked is None else asked)
        endings.append(tick["ending"])
    return {ending: endings.count(ending) / episodes for ending in sorted(set(endings))}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=80_000)
    parser.add_argument("--episodes", type=int, default=100)
    chosen = parser.parse_args()
    critic = critic_of(train(chosen.steps))
    for rule, inference in (("hic", "inverse-distance"), ("misc", "softmax"), ("misc", "known"), ("robot", "known")):
        print(f"{rule:6} {inference:17} {fly(critic, rule, chosen.episodes, inference=inference)}")
