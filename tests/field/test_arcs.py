"""The closed forms against the physics that they stand in for."""

import cmath
import itertools
import math

import gymnasium
import numpy as np
import pytest

from arkaq_edu.field import GoalSupervisor, World, arcs, motion
from arkaq_edu.field.arcs import CYCLE, STEP, Motion

GAITS = [(100, 100), (91, 109), (109, 91), (194, 194), (-18, 18), (60, -60), (194, -194), (0, 0)]
OFTEN = [0.4, 0.15, 0.15, 0.1, 0.05, 0.05, 0.05, 0.05]
STILL = Motion(0j, 0.0, 0j, 0.0)


def in_both_ways(story):
    """What a story tells with closed forms, and with every step by pymunk; and their choices.

    The choices are how often something was in reach, and how often nothing was.
    """
    choices, out_of_reach = [0, 0], arcs.out_of_reach

    def counted(*where):
        far = bool(out_of_reach(*where))
        choices[far] += 1
        return far

    arcs.coast(tuple(STILL), 0j, 0.1, tuple(STILL))  # compiled while the world is whole
    plain_cycle = getattr(arcs.free_cycle, "py_func", arcs.free_cycle)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arcs, "free_cycle", plain_cycle)  # a compiled one would not be counted
        patch.setattr(arcs, "out_of_reach", counted)
        free = story()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arcs, "free_cycle", plain_cycle)
        patch.setattr(arcs, "out_of_reach", lambda *where: False)
        patch.setattr(arcs, "coast", lambda ball, *rest: (ball, np.empty(0, complex)))
        return free, story(), choices


# The formulas -----------------------------------------------------------------------------------


def test_following_adds_up_what_the_steps_do():
    rng = np.random.default_rng(0)
    for k in range(400):
        v, u = (rng.normal(0, 300, 2) @ [1, 1j] for _ in range(2))
        if k % 2:
            v, u = v.real, u.real
        a, n = rng.choice([250.0, 9810.0, 1e5]), int(rng.integers(1, 100))
        x, w = 0.0, v
        for _ in range(n):
            x += STEP * w
            w += (u - w) * min(1.0, a * STEP / abs(u - w)) if u != w else 0.0
        assert arcs.follow(v, u, a, n) == pytest.approx((x, w), abs=1e-9)


@pytest.mark.parametrize("u", [0.0, 5e-324, 1e-308, 100.0])
def test_following_what_is_followed_already_is_even_motion(u):
    assert arcs.follow(u, u, 250.0, 80) == pytest.approx((u * CYCLE, u))
    assert arcs.follow(0.0, u, 1e6, 80) == pytest.approx((u * 79 * STEP, u))


def test_a_walking_body_ends_on_its_arc():
    forward, turn = 100.0, 0.5
    v = arcs.chord(forward / CYCLE + 0j, -turn / 8, turn / CYCLE)  # as on the chord before
    end = arcs.walk(Motion(0j, 0.0, v, turn / CYCLE), forward / CYCLE + 0j, turn / CYCLE)
    chord = cmath.rect(2 * forward / turn * math.sin(turn / 2), turn / 2)
    assert end.angle == pytest.approx(turn)
    assert abs(end.place - chord) < 1.0  # a velocity is felt one step late


# In the open ------------------------------------------------------------------------------------


def walk(seed, cycles, place, ball, rolls=0.0):
    """Poses and balls of a robot that takes footsteps at random, and sometimes stands."""
    rng, world = np.random.default_rng(seed), World(rng=seed)
    world.reset(place, ball)
    places = []
    for _ in range(cycles):
        if rng.random() < rolls:
            world.roll_ball(tuple(rng.uniform(-1500, 1500, 2)))
        if rng.random() < 0.05:
            world.stand(rng.uniform(0, 1))
        world.cycle(*GAITS[rng.choice(len(GAITS), p=OFTEN)])
        places.append([*world.pose, *world.ball])
    return np.array(places)


def test_a_walk_in_the_open_is_the_same_to_a_millionth_of_a_millimeter():
    for seed in range(6):
        free, stepped, (near, far) = in_both_ways(
            lambda s=seed: walk(s, 12, (-1000.0, 0.0, 1.0 * s), (1900.0, 1000.0))
        )
        assert far >= 12 and near == 0
        assert free == pytest.approx(stepped, abs=1e-6)
        assert np.ptp(free[:, :2], axis=0).max() > 300


def test_a_ball_that_rolls_in_the_open_is_the_same():
    def story():
        world = World(rng=0)
        world.reset((-2000.0, 0.0, 0.5), (0.0, 300.0))
        world.roll_ball((350.0, -250.0))
        places = []
        for _ in range(4):
            world.cycle(60, -60)
            places += [*world.pose, *world.ball]
        return np.array(places)

    free, stepped, choices = in_both_ways(story)
    assert choices == [0, 4]
    assert free == pytest.approx(stepped, abs=1e-6)


# Near things ------------------------------------------------------------------------------------


def test_what_is_out_of_reach_touches_nothing():
    """Near misses: the physics of each cycle, with an ear for every contact."""
    rng, heard = np.random.default_rng(2), []
    misses = 0
    for k in range(1200):
        place = complex(rng.uniform(-2700, 2700), rng.uniform(-1700, 1700))
        if k % 2:
            place = complex(rng.choice([-1, 1]) * rng.uniform(2000, 2700), rng.uniform(-900, 900))
        robot = Motion(place, rng.uniform(-3, 3), cmath.rect(rng.uniform(0, 300), k), 0.0)
        ball = place + cmath.rect(rng.uniform(300, 700), rng.uniform(-3, 3))
        footsteps = GAITS[k % len(GAITS)]
        ball = Motion(ball, 0.0, cmath.rect(rng.choice([0, 100, 300]), rng.uniform(-3, 3)), 0.0)
        wanted = abs(sum(footsteps)) / 2 / CYCLE
        if not arcs.out_of_reach(robot, ball, wanted * 1.1, CYCLE):
            continue
        misses += not arcs.out_of_reach(robot, ball, wanted * 1.1 + 50, CYCLE)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(arcs, "free_cycle", lambda robot, ball, *_: (robot, ball, False))
            world = World(rng=k)
            world.reset((place.real, place.imag, robot.angle), (0.0, 0.0))
            world._robot, world._ball = robot, ball
            world.space.on_collision(begin=lambda *contact: heard.append(contact))
            world.cycle(*footsteps)
    assert misses > 30 and not heard


def anywhere(seed):
    """A walk of 40 cycles from anywhere, with a ball near or far, that rolls at times."""
    rng = np.random.default_rng(seed)
    x, y, heading = rng.uniform((-2300, -1500, -3), (2300, 1500, 3))
    while True:
        ball = tuple(rng.uniform((-2700, -1800), (2700, 1800)))
        if math.dist(ball, (x, y)) > 400 and arcs.is_clear(complex(*ball), 50.0):
            return walk(seed, 40, (x, y, heading), ball, rolls=0.05)


def test_walks_that_touch_things_are_the_same_within_a_millimeter():
    differences, choices = [], np.zeros(2)
    for seed in range(30):
        free, stepped, chosen = in_both_ways(lambda s=seed: anywhere(s))
        differences.append(abs(free - stepped).max(axis=0))
        choices += chosen
    places, angles = np.delete(differences, 2, axis=1).max(axis=1), np.array(differences)[:, 2]
    assert choices.min() > 300, "both ways are used"
    # A contact may enlarge what rounding leaves: most walks agree as well as those in the open.
    assert np.mean(places < 1e-6) >= 0.8
    assert places.max() < 1.0 and angles.max() < 0.01


# Kicks and sightings ----------------------------------------------------------------------------


def test_kicks_score_the_same_goals_and_end_at_the_same_places():
    def story():
        world, supervisor, rows = World(rng=0), GoalSupervisor(1850.0), []
        for _ in range(60):
            supervisor.place(world, world.rng.uniform(-0.4, 0.4))
            motion.turn(world, 0.15)
            supervisor.set_ball(world)
            path = motion.kick(world)
            rows.append([*path[-1], len(path), supervisor.judge(world).is_success, world.time])
        return np.array(rows)

    free, stepped, _ = in_both_ways(story)
    assert free == pytest.approx(stepped, abs=1e-3)
    assert 5 < free[:, 3].sum() < 55


def test_a_kick_is_the_same_to_the_bit_if_someone_watches():
    def kick(watch):
        world = World(rng=4)
        GoalSupervisor(1850.0).place(world, 0.05)
        GoalSupervisor.set_ball(world)
        world.watch = (lambda: seen.append(world.ball)) if watch else None
        return motion.kick(world), world.time

    seen = []
    assert kick(True) == kick(False)
    assert max(math.dist(a, b) for a, b in itertools.pairwise(seen)) < 32


@pytest.mark.parametrize("name", ["BallApproach", "ScoreGoal"])
def test_a_task_shows_the_same_sightings(name):
    env = gymnasium.make(f"arkaq_edu:{name}-v0").unwrapped

    def story():
        rng, seen = np.random.default_rng(1), []
        for episode in range(6):
            seen.append(env.reset(seed=episode)[0])
            for _ in range(15):
                observation, reward, terminated, truncated, _ = env.step(int(rng.integers(3)))
                seen.append(observation)
                seen.append(np.full_like(observation, reward))
                if terminated or truncated:
                    break
        return np.array(seen)

    free, stepped, choices = in_both_ways(story)
    assert choices[1] > 10
    assert np.array_equal(free, stepped)
