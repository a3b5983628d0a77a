"""The kick: against the laws of the blow, and against 50 kicks of a real robot."""

import math
import warnings

import numpy as np
import pytest
from scipy import stats

from arkaq_edu.experiments import load_kicks, record_kicks
from arkaq_edu.field import GoalSupervisor, Kick, World, motion, pitch
from arkaq_edu.field.kick import MARK, PAW_RADIUS, PAW_RATE, PAW_TRAVEL

EXACT = Kick(spread=0.0, swerve=0.0)
BOUNCE = 0.5 * 0.6  # of the paw and of the ball, as pymunk has it: their product


def kicked(ahead=0.0, left=0.0, pose=(-2500.0, 0.0, 0.0), kick=EXACT, rng=0):
    """The ball's way from a place off its mark, seen from the robot."""
    world = World(rng=rng, kick=kick)
    x, y, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    world.reset(pose, (0.0, -1900.0))
    forward, aside = MARK[0] + ahead, MARK[1] + left
    world.put_ball(x + forward * c - aside * s, y + forward * s + aside * c)
    way = np.array(motion.kick(world)) - (x, y)
    assert world.pose == pose
    return way @ np.array([[c, -s], [s, c]])


def start_of(way):
    """Speed and direction (rad) with which the ball leaves, from where it comes to rest."""
    rolled = way[-1] - way[0]
    return math.sqrt(2 * pitch.BALL_DECELERATION * math.hypot(*rolled)), math.atan2(*rolled[::-1])


# The blow ---------------------------------------------------------------------------------------


def test_a_ball_aside_goes_aside_along_the_line_of_the_middles():
    for left in (-25.0, -10.0, 0.0, 10.0, 25.0):
        speed, direction = start_of(kicked(left=left))
        # The middles are a ball's and a paw's radius apart when they touch.
        angle = math.asin((MARK[1] + left) / (pitch.BALL_RADIUS + PAW_RADIUS))
        assert direction == pytest.approx(angle, abs=0.02)
        # A heavy paw hands on its speed along that line, and the bounce on top of it.
        touch = PAW_TRAVEL + (1 - math.cos(angle)) * (pitch.BALL_RADIUS + PAW_RADIUS)
        wanted = (1 + BOUNCE) * PAW_RATE * touch * math.cos(angle)
        assert speed == pytest.approx(wanted, rel=0.05)


def test_a_ball_farther_ahead_is_hit_by_a_faster_paw():
    speeds = [start_of(kicked(ahead=a))[0] for a in (-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0)]
    wanted = (1 + BOUNCE) * PAW_RATE * (PAW_TRAVEL + np.arange(-30, 31, 10))
    assert speeds == pytest.approx(wanted, rel=0.08)
    assert np.all(np.diff(speeds) > 0)


@pytest.mark.parametrize("place", [(70.0, 0.0), (0.0, 80.0), (0.0, -80.0), (-500.0, 0.0)])
def test_a_ball_out_of_reach_stays_where_it_is(place):
    way = kicked(*place)
    assert len(way) == 1
    assert way[0] == pytest.approx((MARK[0] + place[0], MARK[1] + place[1]))


@pytest.mark.parametrize("pose", [(0.0, 0.0, 1.2), (-500.0, 300.0, -0.7), (1500.0, 0.0, 3.0)])
def test_a_kick_is_the_same_in_every_direction(pose):
    turned, straight = kicked(5.0, 8.0, pose), kicked(5.0, 8.0)
    n = min(len(turned), len(straight), 10)
    assert turned[:n] == pytest.approx(straight[:n], abs=1e-6)


def test_a_turn_does_not_go_on_while_the_robot_kicks():
    world = World(rng=0)
    world.reset((-2500.0, 0.0, 0.0), (0.0, -1900.0))
    motion.turn(world, 0.3)
    pose = world.pose
    GoalSupervisor.set_ball(world)
    motion.kick(world)
    assert world.pose == pose


def test_the_paw_is_there_only_while_it_swings():
    world, seen = World(rng=0, kick=EXACT), []
    world.reset((0.0, 0.0, 0.0), MARK)
    world.watch = lambda: seen.append((world.time, world.paw, world.ball))
    motion.kick(world)
    paws = np.array([paw for _, paw, _ in seen if paw is not None])
    assert 10 < len(paws) < len(seen)
    assert np.all(np.diff(paws[:, 0]) > 0) and not paws[:, 1].any()
    assert paws[-1, 0] == pytest.approx(MARK[0] - pitch.BALL_RADIUS - PAW_RADIUS, abs=4)
    assert world.paw is None and all(paw is None for _, paw, _ in seen[len(paws) :])
    assert np.all(np.diff([time for time, *_ in seen]) > 0)
    assert seen[-1][0] == world.time == pytest.approx(0.1 + 1000 / 250, abs=0.6)


# The ball's way ---------------------------------------------------------------------------------


def test_an_exact_kick_is_the_same_every_time():
    ends = record_kicks(5, kick=EXACT)
    assert np.ptp(ends[["x", "y"]].to_numpy(), axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert 1900 < ends.x[0] < 2400 and abs(math.atan2(ends.y[0], ends.x[0])) < 0.04


def test_swerve_bends_the_way_to_either_side_ever_more():
    bent = [kicked(kick=Kick(0.0, 140.0), rng=seed) for seed in range(12)]
    straight = kicked()
    turns = []
    for way in bent:
        middle = way[len(way) // 2] - way[0]
        turns.append(math.atan2(*(way[-1] - way[0])[::-1]) - math.atan2(*middle[::-1]))
        assert math.hypot(*(way[-1] - way[0])) < 1.3 * math.hypot(*(straight[-1] - straight[0]))
    assert min(turns) < -0.05 and max(turns) > 0.05
    assert abs(math.atan2(*np.diff(straight[[0, -1]], axis=0)[0, ::-1])) < 0.04


def test_the_strongest_swerve_still_comes_to_rest():
    rolled = record_kicks(40, kick=Kick(9.0, 200.0))
    assert np.isfinite(rolled[["x", "y"]]).all().all()
    assert np.hypot(rolled.x, rolled.y).max() < 6000


def test_posts_panels_and_the_wall_stop_the_ball():
    world, touched = World(rng=4), 0
    frame = [
        (x, y) for x in np.linspace(2700, 3000, 31) for y in (-450.0, 450.0)
    ]  # the axes of the goal's posts and panels, 50 mm thick
    for trial in range(60):
        world.reset((1300.0, 0.0, world.rng.uniform(-0.5, 0.5)), (0.0, -1900.0))
        GoalSupervisor.set_ball(world)
        deepest = [0.0]

        def look(deepest=deepest):
            x, y = world.ball
            post = 92 - min(math.hypot(x - px, y - py) for px, py in frame)
            deepest.append(max(post, abs(x) + 42 - 3000))

        world.watch = look
        motion.kick(world)
        # A ball goes in by no more than it rolls in a step.
        assert max(deepest) < 31, trial
        touched += max(deepest) > 0
    assert touched > 20


def test_the_back_of_the_goal_gives_back_no_more_than_it_bounces():
    """Pymunk would push twice if the step after a bump were longer than the one before."""
    world, bounced = World(rng=0, kick=EXACT), 0
    for distance in np.linspace(900, 1700, 30):
        world.reset((2700.0 - distance, 0.0, 0.0), (0.0, -1900.0))
        GoalSupervisor.set_ball(world)
        places = []
        world.watch = lambda places=places: places.append((world.time, world.ball[0]))
        motion.kick(world)
        time, x = np.array(places).T
        speeds = np.diff(x) / np.diff(time)
        bump = int(np.argmax(speeds < 0))
        if bump:
            back = 3000 - pitch.BALL_RADIUS - x[-1]
            rolled = (BOUNCE * speeds[bump - 2]) ** 2 / (2 * pitch.BALL_DECELERATION)
            assert back == pytest.approx(rolled, abs=30), distance  # a step into the wall
            bounced += 1
    assert bounced >= 20


def test_the_same_seed_kicks_the_same_to_the_bit():
    first = record_kicks(8, seed=3)
    assert record_kicks(8, seed=3).equals(first)
    assert not record_kicks(8, seed=4).equals(first)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Kick(spread=-1.0), "spread.*-1"),
        (lambda: Kick(spread=50.0), "spread.*50"),
        (lambda: Kick(swerve=250.0), "swerve.*250"),
        (lambda: record_kicks(0), "n must"),
        (lambda: GoalSupervisor(100.0), "distance.*100"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=words):
        call()


# Against the real robot -------------------------------------------------------------------------


def measures(kicks):
    """Range (mm), bearing and, of the balls that got there, bearing at 2 m (degrees)."""
    passed = kicks.y_at_2m.dropna()
    return {
        "range": np.hypot(kicks.x, kicks.y).to_numpy(),
        "bearing": np.degrees(np.arctan2(kicks.y, kicks.x)).to_numpy(),
        "bearing at 2 m": np.degrees(np.arctan2(passed, 2000.0)).to_numpy(),
    }


def energy_test(a, b, resamples, rng):
    """The p-value of the energy distance, by shuffling which kick is whose."""
    test = stats.permutation_test(
        (a, b), stats.energy_distance, n_resamples=resamples, alternative="greater", rng=rng
    )
    return test.pvalue


def anderson_darling_accepts(a, b):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a p-value beyond its table is capped
        test = stats.anderson_ksamp([a, b])
    return test.statistic < test.critical_values[2]  # at the 5 % level


REAL = measures(load_kicks())
SIMULATED = [record_kicks(50, seed=seed) for seed in range(60)]


def test_the_file_holds_the_fifty_kicks_of_the_work_log():
    assert len(load_kicks()) == 50 and len(REAL["bearing at 2 m"]) == 34
    assert REAL["range"].mean() == pytest.approx(2220, abs=5)
    assert REAL["range"].std(ddof=1) == pytest.approx(780, abs=5)
    assert REAL["bearing"].std(ddof=1) == pytest.approx(14.6, abs=0.05)
    assert REAL["bearing at 2 m"].std(ddof=1) == pytest.approx(9.5, abs=0.05)


@pytest.mark.parametrize("measure", list(REAL))
def test_fifty_simulated_kicks_cannot_be_told_from_the_fifty_real_ones(measure):
    """As many of the 60 samples pass a test at the 5 % level as should: 57, and by luck fewer."""
    samples = [measures(kicks)[measure] for kicks in SIMULATED]
    real, few = REAL[measure], stats.binom(60, 0.95).ppf(0.001)
    assert few == 51
    assert sum(stats.ks_2samp(real, s).pvalue > 0.05 for s in samples) >= few
    assert sum(anderson_darling_accepts(real, s) for s in samples) >= few
    shuffles = [energy_test(real, s, 199, k) > 0.05 for k, s in enumerate(samples)]
    assert sum(shuffles) >= few


def test_three_thousand_simulated_kicks_cannot_be_told_from_them_either():
    for measure, real in REAL.items():
        many = np.concatenate([measures(kicks)[measure] for kicks in SIMULATED])
        assert stats.ks_2samp(real, many).pvalue > 0.1, measure
        assert anderson_darling_accepts(real, many), measure


def test_range_and_bearing_go_together_as_little_as_in_reality():
    def together(kicks):
        m = measures(kicks)
        both = kicks.dropna()
        angles = np.arctan2(both.y, both.x), np.arctan2(both.y_at_2m, 2000.0)
        return (
            stats.spearmanr(m["range"], np.abs(m["bearing"])).statistic,
            np.arctanh(np.corrcoef(*angles)[0, 1]),
            stats.skew(m["range"]),
        )

    real = together(load_kicks())
    many = np.array([together(kicks) for kicks in SIMULATED])
    low, high = np.quantile(many, [0.005, 0.995], axis=0)
    assert np.all(low < real) and np.all(real < high)


@pytest.mark.parametrize(
    ("kick", "measure"),
    [
        (Kick(spread=4.5), "range"),
        (Kick(spread=0.0), "range"),
        (Kick(swerve=0.0), "bearing"),
        (Kick(swerve=0.0, spread=4.5), "bearing at 2 m"),
    ],
)
def test_the_tests_can_tell_another_kick(kick, measure):
    other = measures(record_kicks(1000, kick=kick))[measure]
    assert not anderson_darling_accepts(REAL[measure], other)
    assert energy_test(REAL[measure], other, 199, 0) < 0.05
