#!/usr/bin/env python3
"""A plant outside cohelm: a cart on a rail that is to stop at one of two marks. Standard library only.

    python3 examples/external-plant/plant.py --listen 5005
    cohelm fly --external 127.0.0.1:5005

docs/external-plants.md explains the protocol. Replace `Cart` by your machine; the rest can stay as it is.
"""

import argparse
import json
import random
import socket
import sys

PUSH = 1.6  # units a second squared at full push
DRAG = 0.5  # share of the speed lost in a second
REACH = 0.05  # how near (units) and how slow (units a second) counts as being there
LIMIT_S = 30.0  # seconds an episode may last
HELLO_WITHIN_S = 5.0  # for who connects to begin: a stranger who says nothing must not keep others out
START_WITHIN_S = 600.0  # from being ready to the first tick; the person takes that time, and nothing moves yet


class Cart:
    """x from -1 to 1, a speed, and two marks of which one is the pilot's."""

    name = "cart"
    space = {"kind": "axes", "names": ["x"], "low": [-1.0], "high": [1.0]}

    def __init__(self, ticks_per_second=50.0):
        self.ticks_per_second = ticks_per_second
        self.push = 0.0

    def begin(self, seed):
        draws = random.Random(seed)
        self.x, self.v, self.push = 0.0, 0.0, 0.0
        self.marks = [draws.uniform(-0.85, -0.35), draws.uniform(0.35, 0.85)]
        self.wanted = draws.randrange(2)
        self.ticks = 0

    def move(self, action):
        """One tick: the push, held to what the rail takes."""
        tick_s = 1.0 / self.ticks_per_second
        self.push = 0.0 if action is None else max(-1.0, min(1.0, float(action[0])))
        self.v += (PUSH * self.push - DRAG * self.v) * tick_s
        self.x += self.v * tick_s
        self.ticks += 1

    def stop(self):
        """What a real machine does when nobody steers it any more."""
        self.push = 0.0

    def ending(self):
        if abs(self.x) > 1.0:
            return "out-of-bounds"
        for index, mark in enumerate(self.marks):
            if abs(self.x - mark) < REACH and abs(self.v) < REACH:
                return "goal" if index == self.wanted else "elsewhere"
        return "time-limit" if self.ticks >= LIMIT_S * self.ticks_per_second else None

    def scene(self):
        def box(w, h, y=0.0):
            return {"kind": "polygon", "points": [[-w, y], [w, y], [w, y + h], [-w, y + h]]}

        def mark(index):
            x = self.marks[index]
            line = {"kind": "polygon", "points": [[x - REACH, -0.04], [x + REACH, -0.04], [x + REACH, 0.0], [x - REACH, 0.0]]}
            return {"role": "goal", "goal": index, "shapes": [line]}

        rail = {"role": "ground", "shapes": [{"kind": "polygon", "points": [[-1.3, -0.3], [1.3, -0.3], [1.3, 0.0], [-1.3, 0.0]]}]}
        wheels = [{"kind": "disc", "center": [x, 0.03], "radius": 0.03} for x in (-0.06, 0.06)]
        cart = {"role": "body", "shapes": [box(0.1, 0.1, 0.04), *wheels]}
        return {
            "bounds": [-1.2, -0.3, 1.2, 0.9],
            "fixed": [rail, mark(0), mark(1)],
            "movable": [cart],
            "origin": [0.0, 0.0],
            "scale": [1.0, 1.0],
        }

    def seen(self):
        return {
            "state": [self.x, self.v],
            "position": [self.x, 0.0],
            "poses": [{"x": self.x, "y": 0.0, "angle_rad": 0.0, "strength": 1.0}],
        }

    def goals(self):
        return [{"id": index, "position": [mark, 0.0]} for index, mark in enumerate(self.marks)]


def say(connection, message):
    # allow_nan=False: NaN is no JSON, and cohelm would take the plant for lost.
    connection.sendall(json.dumps(message, allow_nan=False).encode() + b"\n")


def fly(connection, cart):
    """One episode: hello, begin, ticks, end. Raises what Python raises if cohelm breaks off or is not cohelm."""
    connection.settimeout(HELLO_WITHIN_S)
    lines = connection.makefile("r", encoding="utf-8")
    say(connection, {"cohelm": 1, "name": cart.name, "ticks_per_second": cart.ticks_per_second, "space": cart.space})
    line = lines.readline()
    if not line:
        return "cohelm went away"
    begin = json.loads(line)["begin"]
    cart.begin(begin["seed"])
    silence_s = begin["time_out_ms"] / 1000
    connection.settimeout(START_WITHIN_S)
    say(connection, {"scene": cart.scene(), "pilot_goal": cart.wanted, "goals": cart.goals(), **cart.seen()})
    ending = None
    while ending is None:
        line = lines.readline()
        if not line:
            return "cohelm went away"
        # From the first tick on silence means that nobody steers: the socket's time-out is this plant's dead man.
        connection.settimeout(silence_s)
        message = json.loads(line)
        if "end" in message:
            return message["end"]
        cart.move(message["action"])
        ending = cart.ending()
        reward = 1.0 if ending == "goal" else 0.0
        say(connection, {"tick": message["tick"], "reward": reward, "ending": ending, **cart.seen()})
    return ending


def serve(connection, cart):
    """One episode, after which the cart stands still: whatever happened, and whatever was heard."""
    try:
        return fly(connection, cart)
    except Exception as error:  # a broken connection, or a line that is no JSON, not of the protocol, or too much for Python
        return f"lost, {type(error).__name__}: {error}"
    finally:
        cart.stop()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--listen", type=int, default=5005, help="port on this machine, 5005 if none is named; 0 for any free one")
    parser.add_argument("--ticks-per-second", type=float, default=50.0, help="1 to 200")
    options = parser.parse_args()
    try:
        server = socket.create_server(("127.0.0.1", options.listen))
    except (OSError, OverflowError) as error:
        sys.exit(f"cannot listen at port {options.listen}: {error}; try another with --listen")
    with server:
        print(f"the cart listens at 127.0.0.1:{server.getsockname()[1]}", flush=True)
        while True:
            connection, _ = server.accept()
            with connection:
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                print("episode:", serve(connection, Cart(options.ticks_per_second)), flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(0)
