"""Records what PyTorch computes for small networks: outputs, losses, gradients and Adam steps.

Run:  pip install torch==2.15.0 numpy safetensors && python record_pytorch.py
Writes pytorch.json (read by tests/pytorch.rs) and pytorch.safetensors (weights as PyTorch users save them).

Weights and inputs are f32; PyTorch computes in f64 from them, so that only our rounding is in the difference.
Names and orientation of the weights are those of docs/networks.md. PyTorch's nn.LSTM has two biases that are only
ever added: the second is zero and not trained here.
"""

import json

import torch
from safetensors.torch import save_file
from torch import nn

torch.manual_seed(7)
here = __file__.rsplit("/", 1)[0] if "/" in __file__ else "."


def f32(*shape, scale=1.0):
    """Numbers that f32 holds exactly, to compute with in f64."""
    return (scale * torch.randn(*shape)).float().double()


def rounded(tensor):
    """Ten digits: far below what f32 resolves."""
    return [float(f"{x:.10g}") for x in tensor.detach().double().flatten().tolist()]


def entry(tensor):
    return {"shape": list(tensor.shape), "data": rounded(tensor)}


def linear(inputs, outputs):
    layer = nn.Linear(inputs, outputs)
    return layer.float().double()


class Mlp(nn.Module):
    def __init__(self, widths, head, outputs):
        super().__init__()
        self.hidden = nn.ModuleList(linear(a, b) for a, b in zip(widths, widths[1:]))
        self.dueling = head == "dueling"
        if self.dueling:
            self.advantage, self.value = linear(widths[-1], outputs), linear(widths[-1], 1)
        else:
            self.output = linear(widths[-1], outputs)

    def forward(self, x):
        for layer in self.hidden:
            x = torch.relu(layer(x))
        if not self.dueling:
            return self.output(x)
        a = self.advantage(x)
        return self.value(x) + a - a.mean(dim=1, keepdim=True)


class Lstm(nn.Module):
    def __init__(self, inputs, cells, outputs):
        super().__init__()
        self.lstm = nn.LSTM(inputs, cells).float().double()
        self.head = linear(cells, outputs)
        nn.init.zeros_(self.lstm.bias_hh_l0)
        self.lstm.bias_hh_l0.requires_grad_(False)

    def forward(self, x, lengths):
        """x: [ticks, sequences, inputs] -> list of [length, outputs], one a sequence."""
        packed = nn.utils.rnn.pack_padded_sequence(x, lengths, enforce_sorted=False)
        hidden, _ = nn.utils.rnn.pad_packed_sequence(self.lstm(packed)[0])
        out = self.head(hidden)
        return [out[:n, i] for i, n in enumerate(lengths)]


def state(net):
    return {k: entry(v) for k, v in net.state_dict().items() if not k.endswith("bias_hh_l0")}


def gradients(net):
    return {k: entry(p.grad) for k, p in net.named_parameters() if p.grad is not None}


def step_of(net, loss):
    net.zero_grad()
    value = loss()
    value.backward()
    return value


def mlp_case(widths, head, outputs, loss_name, largest_norm):
    net = Mlp(widths, head, outputs)
    x = f32(6, widths[0])
    target = f32(6, outputs)
    actions = torch.arange(6) % outputs

    def loss():
        y = net(x)
        if loss_name == "mse":
            return nn.functional.mse_loss(y, target)
        picked = y[torch.arange(6), actions]
        return nn.functional.smooth_l1_loss(picked, 3 * target[:, 0])

    case = {"head": head, "loss_name": loss_name, "weights": state(net), "x": entry(x)}
    case["target"] = entry(target if loss_name == "mse" else 3 * target[:, 0])
    case["outputs"] = entry(net(x))
    case["loss"] = step_of(net, loss).item()
    case["gradients"] = gradients(net)
    optimiser = torch.optim.Adam(net.parameters(), lr=0.01)
    for _ in range(5):
        step_of(net, loss)
        if largest_norm:
            nn.utils.clip_grad_norm_(net.parameters(), largest_norm)
        optimiser.step()
    case |= {"learning_rate": 0.01, "steps": 5, "largest_norm": largest_norm, "after_adam": state(net)}
    return case


def lstm_case(loss_name):
    net = Lstm(3, 5, 3)
    lengths = [4, 6, 1]
    x = f32(6, 3, 3)
    goals = f32(3, 2)
    truth = [2, 0, 1]

    def loss():
        total = 0.0
        for out, true in zip(net(x, lengths), truth):
            if loss_name == "cross_entropy":
                logits = out
            else:
                mu, ln_sigma = out[:, :2], out[:, 2:]
                squared = ((goals[None] - mu[:, None]) ** 2).sum(-1)
                logits = -squared / (2 * torch.exp(2 * ln_sigma))
            total = total + nn.functional.cross_entropy(logits, torch.full((len(out),), true), reduction="sum")
        return total / sum(lengths)

    case = {"loss_name": loss_name, "lengths": lengths, "truth": truth, "weights": state(net)}
    case |= {"x": entry(x.transpose(0, 1)), "goals": entry(goals)}
    case["outputs"] = [entry(o) for o in net(x, lengths)]
    case["loss"] = step_of(net, loss).item()
    case["gradients"] = gradients(net)
    return case


record = {
    "torch": torch.__version__,
    "mlp": [
        mlp_case([3, 5, 4], "plain", 2, "mse", None),
        mlp_case([4, 8, 6], "dueling", 3, "huber", None),
        mlp_case([4, 8], "dueling", 3, "huber", 0.05),
    ],
    "lstm": [lstm_case("cross_entropy"), lstm_case("goals")],
}
with open(f"{here}/pytorch.json", "w") as out:
    json.dump(record, out, indent=None, separators=(",", ":"))
    out.write("\n")

# A network as a PyTorch user hands it over: f32, one file, the mark of the format in its metadata.
net = Mlp([4, 8, 6], "dueling", 3)
x = f32(2, 4)
weights = {k: v.detach().float().contiguous() for k, v in net.state_dict().items()}
metadata = {"cohelm.weights": "1", "x": json.dumps(rounded(x)), "outputs": json.dumps(rounded(net(x)))}
save_file(weights, f"{here}/pytorch.safetensors", metadata=metadata)
