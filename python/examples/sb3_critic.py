"""Somebody else's critic: a DQN of Stable-Baselines3 is trained on the flag task, and MISC flies with its values."""

import argparse

import cohelm
import gymnasium
from cohelm.envs import CriticView
from stable_baselines3 import DQN

TASK = {"actions": "main-side"}


def train(steps, seed=0):
    """A DQN that sees the state and the own goal, and chooses commands."""
    env = CriticView(gymnasium.make("cohelm/FlagLander-v1", **TASK))
    dqn = DQN(
        "MlpPolicy",
        env,
        learning_rate=5e-4,
        gamma=0.99,
        batch_size=128,
        buffer_size=200_000,
        learning_starts=2_000,
        train_freq=4,
        gradient_steps=2,
        target_update_interval=500,
        exploration_fraction=0.3,
        exploration_final_eps=0.05,
        policy_kwargs={"net_arch": [64, 64]},
        seed=seed,
        device="cpu",
    )
    return dqn.learn(steps)


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
    parser.add_argument("--steps", type=int, default=150_000)
    parser.add_argument("--episodes", type=int, default=100)
    chosen = parser.parse_args()
    critic = critic_of(train(chosen.steps))
    for rule, inference in (("hic", "inverse-distance"), ("misc", "softmax"), ("misc", "known"), ("robot", "known")):
        print(f"{rule:6} {inference:17} {fly(critic, rule, chosen.episodes, inference=inference)}")
