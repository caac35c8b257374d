"""Our weights in PyTorch: the value network and the intent network, the same numbers to 1e-5."""

import cohelm
import numpy as np
import torch
from safetensors.torch import load
from torch.nn.functional import linear, relu


class Values(torch.nn.Module):
    def __init__(self, file: bytes):
        super().__init__()
        self.of = {name.removeprefix("values."): tensor for name, tensor in load(file).items()}

    def forward(self, x):
        for layer in range(sum(name.startswith("hidden.") for name in self.of) // 2):
            x = relu(linear(x, self.of[f"hidden.{layer}.weight"], self.of[f"hidden.{layer}.bias"]))
        if "output.weight" in self.of:  # a plain head; the others are dueling
            return linear(x, self.of["output.weight"], self.of["output.bias"])
        advantage = linear(x, self.of["advantage.weight"], self.of["advantage.bias"])
        return linear(x, self.of["value.weight"], self.of["value.bias"]) + advantage - advantage.mean(-1, keepdim=True)


class Critic(torch.nn.Module):
    """Q(s, a) of actions on axes in two towers: V(s) + w(s) · (φ(a) − φ̄), φ̄ the mean over some actions of reference."""

    def __init__(self, file: bytes):
        super().__init__()
        of = {name.removeprefix("values."): tensor for name, tensor in load(file).items()}
        self.action = of["action.weight"], of["action.bias"]
        hidden = sum(name.startswith("state.hidden.") for name in of) // 2
        names = [f"state.hidden.{layer}" for layer in range(hidden)] + ["state.output"]
        self.state = [(of[f"{name}.weight"], of[f"{name}.bias"]) for name in names]

    def forward(self, x):
        for weight, bias in self.state[:-1]:
            x = relu(linear(x, weight, bias))
        return linear(x, *self.state[-1])

    def embed(self, encoded):
        return relu(linear(encoded, *self.action))


class Intent(torch.nn.Module):
    def __init__(self, file: bytes, network: str):
        super().__init__()
        of = {name.removeprefix(f"{network}."): tensor for name, tensor in load(file).items() if network in name}
        gates, cells = of["lstm.weight_ih_l0"], of["lstm.weight_hh_l0"].shape[1]
        self.lstm = torch.nn.LSTM(gates.shape[1], cells, batch_first=True)
        self.head = torch.nn.Linear(cells, of["head.bias"].shape[0])
        of["lstm.bias_hh_l0"] = torch.zeros(4 * cells)  # PyTorch keeps two biases that are only ever added
        self.load_state_dict(of)

    def forward(self, x):
        return self.head(self.lstm(x)[0])


def apart(theirs, ours):
    return float(np.abs(theirs - ours).max() / max(1.0, np.abs(theirs).max()))


def compare(models=None, seed=0):
    """The largest difference between our numbers and PyTorch's, as a share of the largest number (at least 1)."""
    draws = np.random.default_rng(seed)
    differences = {}
    with torch.no_grad():
        for name, model in (models or cohelm.shipped()).items():
            if isinstance(model, cohelm.ValueModel):
                axes = "values.action.weight" in load(model.to_bytes())
                network = Critic(model.to_bytes()) if axes else Values(model.to_bytes())
                width = (network.state[0][0] if axes else network.of["hidden.0.weight"]).shape[1]
                inputs = draws.normal(size=(64, width)).astype(np.float32)
                differences[name] = apart(network(torch.from_numpy(inputs)).numpy(), model.forward(inputs))
                if axes:
                    encoded = draws.normal(size=(64, network.action[0].shape[1])).astype(np.float32)
                    theirs = network.embed(torch.from_numpy(encoded)).numpy()
                    differences[f"{name}.action"] = apart(theirs, model.embed(encoded))
                continue
            for part in ("regression", "calibrated"):
                lstm = Intent(model.to_bytes(), part)
                inputs = draws.normal(size=(50, lstm.lstm.input_size)).astype(np.float32)
                theirs = lstm(torch.from_numpy(inputs)[None]).numpy()[0]
                differences[f"{name}.{part}"] = apart(theirs, model.forward(part, inputs))
    return differences


if __name__ == "__main__":
    for name, difference in compare().items():
        print(f"{name:50} differs by {difference:.1e} at most")
