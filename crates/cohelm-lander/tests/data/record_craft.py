#!/usr/bin/env python3
"""Record the craft with Box2D itself in situations that Gymnasium's task never shows.

    pip install "gymnasium[box2d]==1.4.0"          # embeds Box2D 2.3.0
    python record_craft.py OUT.jsonl.gz FIRST_SEED SEEDS [STRIDE]

The same hull, legs and engine formulas as Gymnasium's, but over random chains of ground, begun anywhere with any velocity, with
any combination of engines at once, going on after crashes, and woken again after it has slept. One JSON object a line:

    ground       [m][2]      vertices of the chain, left to right
    gravity      float
    iterations   [2]         velocity, position
    start        [6]         x, y, vx, vy, push x, push y
    controls     [n][7]      main, left, right throttle, two draws in [-1, 1) for the dispersion, wind force, wind torque
    notes        one after every STRIDE ticks (default 1):
      tick       int         ticks so far
      bodies     [3][6]      hull, first leg, second leg: x, y, angle, vx, vy, angular velocity; f32 widened
      contact    [3]         hull has touched, first leg touches, second leg touches
      awake      bool        the hull is awake
"""
import gzip, json, math, sys
import Box2D
import numpy as np
from Box2D.b2 import edgeShape, fixtureDef, polygonShape, revoluteJointDef
from gymnasium.envs.box2d import lunar_lander as gym


class Listener(Box2D.b2ContactListener):
    def __init__(self):
        super().__init__()
        self.hull = self.legs = None
        self.hull_touched, self.leg_touches = False, [False, False]

    def BeginContact(self, contact):
        bodies = (contact.fixtureA.body, contact.fixtureB.body)
        self.hull_touched |= self.hull in bodies
        for i, leg in enumerate(self.legs):
            if leg in bodies:
                self.leg_touches[i] = True

    def EndContact(self, contact):
        for i, leg in enumerate(self.legs):
            if leg in (contact.fixtureA.body, contact.fixtureB.body):
                self.leg_touches[i] = False


def build(ground, gravity, start):
    x, y, vx, vy, push_x, push_y = start
    world = Box2D.b2World(gravity=(0, gravity))
    listener = Listener()
    world.contactListener = listener
    moon = world.CreateStaticBody()
    for p1, p2 in zip(ground, ground[1:]):
        moon.CreateEdgeFixture(vertices=[tuple(p1), tuple(p2)], density=0, friction=0.1)
    hull = world.CreateDynamicBody(position=(x, y), angle=0.0, fixtures=fixtureDef(
        shape=polygonShape(vertices=[(px / gym.SCALE, py / gym.SCALE) for px, py in gym.LANDER_POLY]),
        density=5.0, friction=0.1, categoryBits=0x0010, maskBits=0x001, restitution=0.0))
    hull.ApplyForceToCenter((push_x, push_y), True)
    legs = []
    for i in (-1, 1):
        leg = world.CreateDynamicBody(
            position=(x - i * gym.LEG_AWAY / gym.SCALE, y), angle=i * 0.05, fixtures=fixtureDef(
                shape=polygonShape(box=(gym.LEG_W / gym.SCALE, gym.LEG_H / gym.SCALE)),
                density=1.0, restitution=0.0, categoryBits=0x0020, maskBits=0x001))
        joint = revoluteJointDef(
            bodyA=hull, bodyB=leg, localAnchorA=(0, 0),
            localAnchorB=(i * gym.LEG_AWAY / gym.SCALE, gym.LEG_DOWN / gym.SCALE), enableMotor=True, enableLimit=True,
            maxMotorTorque=gym.LEG_SPRING_TORQUE, motorSpeed=0.3 * i)
        joint.lowerAngle, joint.upperAngle = (0.9 - 0.5, 0.9) if i == -1 else (-0.9, -0.9 + 0.5)
        world.CreateJoint(joint)
        legs.append(leg)
    for body in (hull, *legs):
        body.linearVelocity = (vx, vy)
    listener.hull, listener.legs = hull, legs
    return world, listener, hull, legs


def fire(hull, controls):
    main, left, right, draw_a, draw_b, force, torque = controls
    if force or torque:
        hull.ApplyForceToCenter((force, 0.0), True)
        hull.ApplyTorque(torque, True)
    tip = (math.sin(hull.angle), math.cos(hull.angle))
    side = (-tip[1], tip[0])
    spread = [draw_a / gym.SCALE, draw_b / gym.SCALE]
    pushes = []
    if main > 0:
        reach = gym.MAIN_ENGINE_Y_LOCATION / gym.SCALE + 2 * spread[0]
        ox, oy = tip[0] * reach + side[0] * spread[1], -tip[1] * reach - side[1] * spread[1]
        at = (hull.position[0] + ox, hull.position[1] + oy)
        pushes.append(((-ox * gym.MAIN_ENGINE_POWER * main, -oy * gym.MAIN_ENGINE_POWER * main), at))
    for direction, power in ((-1, left), (1, right)):
        if power > 0:
            reach = 3 * spread[1] + direction * gym.SIDE_ENGINE_AWAY / gym.SCALE
            ox, oy = tip[0] * spread[0] + side[0] * reach, -tip[1] * spread[0] - side[1] * reach
            at = (hull.position[0] + ox - tip[0] * 17 / gym.SCALE,
                  hull.position[1] + oy + tip[1] * gym.SIDE_ENGINE_HEIGHT / gym.SCALE)
            pushes.append(((-ox * gym.SIDE_ENGINE_POWER * power, -oy * gym.SIDE_ENGINE_POWER * power), at))
    for impulse, at in pushes:
        hull.ApplyLinearImpulse(impulse, at, True)


def flight(seed, stride):
    draw = np.random.default_rng(seed)
    xs = np.cumsum(draw.uniform(0.05, 3, 14))
    ground = [[float(px - xs[0]), float(draw.uniform(0, 4))] for px in xs]
    pad = int(draw.integers(3, 10))
    ground[pad + 1][1] = ground[pad][1]
    px, py = ground[pad]
    near = bool(draw.integers(2))
    start = [px + float(draw.uniform(-1, 3)), py + float(draw.uniform(0.9, 2) if near else draw.uniform(3, 10)),
             float(draw.uniform(-3, 3)), float(draw.uniform(-8, 1)),
             *(float(v) for v in draw.uniform(-1000, 1000, 2) * draw.integers(2))]
    iterations = [[180, 60], [60, 20], [8, 3]][int(draw.integers(3))]
    gravity = -10.0 if draw.integers(2) else float(draw.uniform(-12, -1))
    world, listener, hull, legs = build(ground, gravity, start)
    out = dict(ground=ground, gravity=gravity, iterations=iterations, start=start, controls=[], notes=[])
    burning, left = [0.0, 0.0, 0.0], 0
    for _ in range(int(draw.integers(100, 400))):
        if left == 0:
            burning = [round(draw.uniform(0.5, 1), 3) if draw.random() < share else 0.0 for share in (0.35, 0.25, 0.25)]
            left = int(draw.integers(1, 15)) if draw.random() < 0.7 else 60
            if left == 60:
                burning = [0.0, 0.0, 0.0]
        left -= 1
        windy = seed % 3 == 0 and hull.awake
        wind = [round(draw.uniform(-15, 15), 2), round(draw.uniform(-1.5, 1.5), 2)] if windy else [0.0, 0.0]
        controls = [*burning, *(round(v, 3) for v in draw.uniform(-1, 1, 2).tolist()), *wind]
        fire(hull, controls)
        world.Step(1.0 / 50, *iterations)
        out["controls"].append(controls)
        if len(out["controls"]) % stride == 0:
            bodies = [[float(v) for v in (b.position.x, b.position.y, b.angle, b.linearVelocity.x, b.linearVelocity.y,
                                          b.angularVelocity)] for b in (hull, *legs)]
            out["notes"].append(dict(tick=len(out["controls"]), bodies=bodies, awake=bool(hull.awake),
                                     contact=[listener.hull_touched, *listener.leg_touches]))
        if hull.position.y < -5 or abs(hull.position.x) > 60 or hull.position.y > 60:
            break
    return out


if __name__ == "__main__":
    out, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    stride = int(sys.argv[4]) if len(sys.argv) > 4 else 1
    ticks = slept = 0
    with gzip.GzipFile(out, "wb", mtime=0) as file:
        for seed in range(first, first + count):
            line = flight(seed, stride)
            file.write((json.dumps(line, separators=(",", ":")) + "\n").encode())
            ticks, slept = ticks + len(line["controls"]), slept + any(not note["awake"] for note in line["notes"])
    print(f"{out}: {count} flights, {ticks} ticks, {slept} slept at some time")
