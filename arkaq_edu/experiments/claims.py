"""Every number and every claim of the thesis's results, and what judges it.

A row is a `Claim`: what is measured, where the thesis prints what about it, and why ours is as it
is. Its values come from `computed` (what needs no seed) or from the runs of both problems.

Examples
--------
>>> from arkaq_edu.experiments.runs import tidy
>>> rows = tidy([(0, {"centers, vigilance 0.15": 130}), (1, {"centers, vigilance 0.15": 140})])
>>> judge(rows)[["quantity", "thesis", "mean", "off_by", "verdict"]].values.tolist()
[['centers, vigilance 0.15', '137', 135.0, -2.0, 'inside']]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

INSIDE, OUTSIDE = "inside", "outside"
WRONG, NO_NUMBER = "wrong in the thesis", "not a claim of numbers"
#: The verdicts, in the order of a page.
VERDICTS = (INSIDE, OUTSIDE, WRONG, NO_NUMBER)

#: Digits of a mean and of the ends of a band.
DIGITS = 4

Values = NDArray[np.float64]


def band(values: ArrayLike) -> tuple[float, float]:
    """Return the band that holds 95 % of the seeds.

    Examples
    --------
    >>> band(range(41))
    (1.0, 39.0)
    """
    low, high = np.quantile(np.asarray(values, dtype=float), [0.025, 0.975])
    return float(low), float(high)


def above_zero(values: Values) -> bool:
    """Judge a claim that one thing is more than another, given the differences, seed by seed.

    Examples
    --------
    >>> above_zero(np.array([1.0, 2.0])), above_zero(np.array([-1.0, 2.0]))
    (True, False)
    """
    return band(values)[0] > 0


def around_zero(values: Values) -> bool:
    """Judge a claim that two things are about the same, given the differences, seed by seed.

    Examples
    --------
    >>> around_zero(np.array([-1.0, 2.0])), around_zero(np.array([1.0, 2.0]))
    (True, False)
    """
    low, high = band(values)
    return low <= 0 <= high


def below_one(values: Values) -> bool:
    """Judge a claim that something shrinks, given by how much, seed by seed.

    Examples
    --------
    >>> below_one(np.array([0.8, 0.9])), below_one(np.array([0.8, 1.2]))
    (True, False)
    """
    return band(values)[1] < 1


@dataclass(frozen=True)
class Claim:
    """What the thesis prints about a quantity, and how ours is judged.

    Parameters
    ----------
    quantity : str
        The name in the runs.
    place : str
        Where the thesis prints it: a figure, an equation, a section.
    thesis : str or None
        The number as it is printed, or a claim in a few words. None if the thesis prints nothing.
    why : str
        Why ours is as it is, in one sentence.
    holds : function, optional
        Judges a claim in words: takes the values, one a seed, and returns whether it holds. A
        number holds if it lies in the band over the seeds, to the digits that are printed.
    wrong : bool
        Whether a claim that does not hold is known to be wrong, rather than different here.
    of : function, optional
        Makes the values of other quantities of the same seed: takes the runs, one row a seed, one
        column a quantity.

    Examples
    --------
    >>> Claim("x", "figure 5.40", "60", "why").verdict(np.array([55.0, 64.0]))
    'inside'
    >>> Claim("x", "figure 5.40", "> 0", "why", above_zero, wrong=True).verdict(np.array([-1.0]))
    'wrong in the thesis'
    """

    quantity: str
    place: str
    thesis: str | None
    why: str
    holds: Callable[[Values], bool] | None = None
    wrong: bool = False
    of: Callable[[pd.DataFrame], pd.Series] | None = None

    @property
    def number(self) -> float | None:
        """The printed number, None for words and for nothing."""
        try:
            return float(self.thesis or "")
        except ValueError:
            return None

    def verdict(self, values: Values) -> str:
        """Return one of `VERDICTS`."""
        if self.thesis is None:
            return NO_NUMBER
        if self.holds is not None:
            agrees = self.holds(values)
        else:
            digits = len(self.thesis.partition(".")[2])
            low, high = (round(end, digits) for end in band(values))
            agrees = low <= float(self.thesis) <= high
        return INSIDE if agrees else WRONG if self.wrong else OUTSIDE


def _counted(claim: Claim, found: Values) -> str:
    """Return the reason; where a claim is about a sign, also in how many seeds it is so."""
    if claim.holds not in (above_zero, below_one) or len(found) < 2:
        return claim.why
    so = sum(claim.holds(value) for value in found[:, np.newaxis])
    return f"{claim.why} It is so in {so} of {len(found)} seeds."


def judge(runs: pd.DataFrame) -> pd.DataFrame:
    """Return the verdict on every claim whose quantity has been measured.

    Parameters
    ----------
    runs : DataFrame
        Columns quantity, seed, value. What is computed without a seed has none.

    Returns
    -------
    DataFrame
        One row a claim, in the thesis's order: quantity, thesis (as printed), place, mean, low and
        high (the band that holds 95 % of the seeds), off_by (mean minus thesis), verdict, why,
        seeds (0 for what is computed without a seed). Numbers have four digits.
    """
    runs = with_derived(runs)
    values = {name: part.value.to_numpy() for name, part in runs.groupby("quantity", sort=False)}
    seeds = runs.groupby("quantity").seed.count()
    rows = []
    for claim in CLAIMS:
        if claim.quantity not in values:
            continue
        found = values[claim.quantity]
        mean, (low, high) = rounded(found.mean()), map(rounded, band(found))
        printed = claim.number
        off = float("nan") if printed is None else rounded(found.mean() - printed)
        verdict = claim.verdict(found)
        rows.append(
            (claim.quantity, claim.thesis or "", claim.place, mean, low, high, off, verdict,
             _counted(claim, found), int(seeds[claim.quantity]))
        )  # fmt: skip
    names = [
        "quantity", "thesis", "place", "mean", "low", "high", "off_by", "verdict", "why", "seeds",
    ]  # fmt: skip
    return pd.DataFrame(rows, columns=names)


def with_derived(runs: pd.DataFrame) -> pd.DataFrame:
    """Add the quantities that claims make of others, such as the difference of two policies.

    Examples
    --------
    >>> runs = pd.DataFrame({"quantity": ["centers, vigilance 0.15", "centers, vigilance 0.025"],
    ...                      "seed": 3, "value": [150.0, 2200.0]})
    >>> name, seed, value = with_derived(runs).iloc[-1]
    >>> name, int(seed), float(value)
    ('centers at vigilance 0.15 minus those at 0.025', 3, -2050.0)
    """
    wide = runs.dropna(subset="seed").pivot(index="seed", columns="quantity", values="value")
    parts = [runs]
    for claim in CLAIMS:
        if claim.of is not None and claim.quantity not in set(runs.quantity):
            try:
                made = claim.of(wide).dropna()
            except KeyError:
                continue  # these runs do not have its parts
            parts.append(made.map(rounded_value).rename("value").reset_index())
            parts[-1].insert(0, "quantity", claim.quantity)
    return pd.concat(parts, ignore_index=True)


def rounded(value: float, digits: int = DIGITS) -> float:
    """Return a number with so many significant digits.

    Examples
    --------
    >>> rounded(57.99999999999999), rounded(0.00034567), rounded(2213.55)
    (58.0, 0.0003457, 2214.0)
    """
    return float(f"{value:.{digits}g}")


def rounded_value(value: float) -> float:
    """Return a measured value without the noise of its last binary digits.

    Examples
    --------
    >>> rounded_value(100 * 0.58)
    58.0
    """
    return rounded(value, 10)


def thesis_numbers() -> dict[str, float]:
    """Return the numbers that the thesis prints, by quantity.

    Examples
    --------
    >>> thesis_numbers()["centers, vigilance 0.1"], thesis_numbers()["goals (%), near, ARKAQ"]
    (333, 60)
    """
    printed = {claim.quantity: claim.number for claim in CLAIMS if claim.number is not None}
    return {name: int(x) if x == int(x) else x for name, x in printed.items()}


# What needs no seed


@lru_cache
def computed() -> dict[str, float]:
    """Return every quantity that is computed, not measured over seeds.

    Examples
    --------
    >>> found = computed()
    >>> found["discounted, middle chain"], found["a floor down: floor 1"]
    (59.049, 0.5)
    """
    parts = (_optimality(), _beliefs(), _two_states(), _match(), _settings(), _cost(), _footsteps())
    return {name: rounded_value(x) for part in parts for name, x in part.items()}


def _optimality() -> dict[str, float]:
    """Figure 2.2: what each chain earns by each model (eq 2.1 to 2.3)."""
    from arkaq_edu.mdp.optimality import CHAINS, earnings

    models = ("horizon of 5", "discounted", "average reward")
    table = earnings(5, 0.9)
    found = {
        f"{model}, {chain} chain": earned
        for model, row in zip(models, table, strict=True)
        for chain, earned in zip(CHAINS, row, strict=True)
    }
    as_printed = earnings(6, 0.9)[0]  # t = 0 ... 5 is six terms
    found["upper minus middle chain, six terms as eq 2.1 prints"] = as_printed[0] - as_printed[1]
    infinite, average = table[1], table[2]
    found["chains that the two models without a horizon choose"] = float(
        len({infinite.argmax(), average.argmax()})
    )
    return found


def _beliefs() -> dict[str, float]:
    """Figures 2.6 and 2.7: beliefs in the building and in the corridor."""
    from arkaq_edu.pomdp import problem, trajectory

    floors = trajectory(problem("floors"), ["down", "dark"]).beliefs[-1]
    found = {f"a floor down: floor {4 - i}": b for i, b in enumerate(floors)}
    corridor = trajectory(problem("corridor"), ["right", "nothing"] * 2).beliefs[::2]
    for when, belief in zip(("at first", "one right", "two right"), corridor, strict=True):
        found |= {f"corridor, {when}: cell {i + 1}": b for i, b in enumerate(belief)}
    return found


def _two_states() -> dict[str, float]:
    """Figure 2.16: what the actions are worth at [.25 .75], and on which side a1 is better."""
    from arkaq_edu.pomdp import problem
    from arkaq_edu.pomdp.belief import expected_rewards

    world = problem("two_state")
    a1, a2 = expected_rewards(world, [0.25, 0.75])
    left, _ = (np.subtract(*expected_rewards(world, [p, 1 - p])) for p in (0.0, 1.0))
    return {"V(a1) at [.25 .75]": a1, "V(a2) at [.25 .75]": a2, "V(a1) - V(a2) at p(s1) = 0": left}


def _match() -> dict[str, float]:
    """Return the norm of r of a perfect match (eq 2.47), and as printed, with c < 0 (eq 2.43)."""
    from arkaq_edu.art.reset import match_norm

    return {"norm of r when cos(u, z) = 1": float(match_norm(1.0, 0.5, 0.1))}


def _settings() -> dict[str, float]:
    """Intervals, scaling and rewards of sections 5.2 and 5.3."""
    from arkaq_edu.arkaq import Sensing
    from arkaq_edu.field import goal, supervisor

    sensing = Sensing.thesis()
    middle, half = sensing.interval()
    return {
        "nearest distance (mm)": sensing.low[0],
        "farthest distance (mm)": sensing.high[0],
        "orientation to the right (rad)": sensing.low[1],
        "orientation to the left (rad)": sensing.high[1],
        "scaling: middle of the distance (mm)": middle[0],
        "scaling: half the interval of the distance (mm)": half[0],
        "scaling: factor of the orientation": 1 / half[1],
        "ball reached within (mm)": supervisor.CLOSE_ENOUGH,
        "reward for reaching the ball": supervisor.CLOSE_REWARD,
        "reward for reaching it straight": supervisor.CLOSE_REWARD + supervisor.STRAIGHT_REWARD,
        "straight within (rad)": supervisor.STRAIGHT_ENOUGH,
        "reward of a goal": goal.GOAL_REWARD,
        "reward of a miss": goal.MISS_REWARD,
    }


def _cost() -> dict[str, float]:
    """Count the numbers on which one update of Q depends: change each, and look for an effect."""
    from arkaq_edu.mdp import QLearner

    n_states, n_actions = 20, 3
    depends = 0
    for changed in np.ndindex(n_states, n_actions):
        learner = QLearner(n_states, n_actions, alpha=0.5, gamma=0.9)
        learner.Q[changed] = 1.0
        depends += learner.update(4, 1, 0.0, 7, terminated=False) != 0.0
    return {"numbers that one update of Q reads, 20 states, 3 actions": float(depends)}


def _footsteps() -> dict[str, float]:
    """Count the footsteps along the interval of the distance and across that of the orientation."""
    from arkaq_edu.arkaq import Sensing
    from arkaq_edu.envs.ball_approach import FOOTSTEPS
    from arkaq_edu.field.motion import gait

    _, half = Sensing.thesis().interval()
    gaits = np.array([gait(*step) for step in FOOTSTEPS])
    ahead, turn = gaits[:, 0].max(), gaits[:, 1].max()
    return {"footsteps along times across": 2 * half[0] / ahead * 2 * half[1] / turn}


# The claims

_PIXELS = "A blob of pixels tells a direction to .001 rad, so this cannot come from pixels."
_RECIPE = (
    "One stream for all five vigilances misses one of the counts by 14 % at best, and this is that "
    "recipe; each count would need a stream of its own length (4,000 to 18,000 patterns)."
)
_ISLANDS = "Turns are nearly equal, so the goal is seen in islands one turn apart."
_CONFIGURED = "It is a setting, and the same here."
_OWN = "The thesis shows pictures of walks and prints no such number."
_FIVE = "The thesis counts five rewards, t = 0 to 4, and so do we."
_FLOORS = (
    "Bayes' rule adds the robots that were on the lowest floor already; the thesis spreads the "
    "belief evenly over all floors that are still possible."
)
_CORRIDOR = "Bayes' rule gives it, if the goal was not seen after either step."
_NEWER = "ARKAQ's greedy policy at the end of training, on fresh starts."


def _minus(one: str, other: str) -> Callable[[pd.DataFrame], pd.Series]:
    return lambda runs: runs[one] - runs[other]


def _best_states(runs: pd.DataFrame) -> pd.Series:
    """Return, for each seed, the number of states of the agent that earned most."""
    runs = runs.dropna(subset=[f"reward, ARKAQ, vigilance {rho}" for rho in _SWEEP])
    reward = runs[[f"reward, ARKAQ, vigilance {rho}" for rho in _SWEEP]].to_numpy()
    states = runs[[f"states, ARKAQ, vigilance {rho}" for rho in _SWEEP]].to_numpy()
    best = reward.argmax(axis=1)
    return pd.Series(states[np.arange(len(best)), best], index=runs.index)


#: The vigilances at which agents are trained, for the claims about the number of states.
_SWEEP = ("0.15", "0.1", "0.075", "0.05", "0.025")
_BEST = "states with which most reward is earned"

_CHAPTER_2 = (
    *(
        Claim(f"horizon of 5, {chain} chain", "figure 2.2", printed, _FIVE)
        for chain, printed in (("upper", "6"), ("middle", "0"), ("lower", "0"))
    ),
    Claim(
        "upper minus middle chain, six terms as eq 2.1 prints", "eq 2.1", "> 0",
        "Up to t = k as printed, six rewards count: 8, 10 and 0, and the middle chain wins.",
        above_zero, wrong=True,
    ),
    *(
        Claim(f"discounted, {chain} chain", "figure 2.2", printed,
              "It is the discounted sum with gamma = .9, which the thesis does not name.")
        for chain, printed in (("upper", "16.2"), ("middle", "59"), ("lower", "58.5"))
    ),
    *(
        Claim(f"average reward, {chain} chain", "section 2.1.1", None,
              "The thesis defines the model (eq 2.3) and prints no number for it.")
        for chain in ("upper", "middle", "lower")
    ),
    Claim(
        "chains that the two models without a horizon choose", "figure 2.2", "the same one",
        'The thesis prefers "the infinite horizon model", but discounted and average reward '
        "choose different chains: the middle and the lower one.",
        lambda values: band(values)[1] == 1, wrong=True,
    ),
    *(
        Claim(f"a floor down: floor {floor}", "figure 2.6", printed, _FLOORS, wrong=True)
        for floor, printed in ((4, "0.00"), (3, "0.33"), (2, "0.33"), (1, "0.33"))
    ),
    *(
        Claim(f"corridor, {when}: cell {cell}", "figure 2.7", printed, _CORRIDOR)
        for when, row in (
            ("at first", ("0.333", "0.333", "0.000", "0.333")),
            ("one right", ("0.100", "0.450", "0.000", "0.450")),
            ("two right", ("0.100", "0.164", "0.000", "0.736")),
        )
        for cell, printed in enumerate(row, start=1)
    ),
    Claim("V(a1) at [.25 .75]", "figure 2.16", "0.25", "It is .25 times 1."),
    Claim("V(a2) at [.25 .75]", "figure 2.16", "1.125", "It is .75 times 1.5."),
    Claim(
        "V(a1) - V(a2) at p(s1) = 0", "figure 2.16", "> 0",
        "On the axis of figure 2.8 the left end is p(s1) = 0, where only a2 earns anything.",
        above_zero, wrong=True,
    ),
    Claim(
        "centers at vigilance 0.15 minus those at 0.025", "section 2.4", "> 0",
        '"Larger vigilance, more clusters" is true of a similarity; here the vigilance is a '
        "distance, and it is the other way round.",
        above_zero, wrong=True,
        of=_minus("centers, vigilance 0.15", "centers, vigilance 0.025"),
    ),
    Claim("norm of r when cos(u, z) = 1", "eq 2.47", "1",
          "It follows from eq 2.47 for 0 < c < 1, though not for the c < 0 of eq 2.43."),
)  # fmt: skip

_CHAPTER_5 = (
    *(
        Claim(f"straight walk of 2 m: {what}", "figure 5.5", "> 0", why, above_zero)
        for what, why in (
            ("drift to the left (mm)",
             "The weight on the left pulls the robot over; the mean of many walks shows it."),
            ("turn to the right (rad)",
             "The left legs slip less and push farther, as the calibrated gait says."),
        )
    ),
    *(
        Claim(quantity, "section 5.2", printed, _CONFIGURED)
        for quantity, printed in (
            ("nearest distance (mm)", "200"), ("farthest distance (mm)", "4100"),
            ("orientation to the right (rad)", "-0.5"), ("orientation to the left (rad)", "0.5"),
        )
    ),
    Claim(
        "error of the distance beyond 3 m (mm, one standard deviation)", "section 5.2", "100",
        'A blob is a few pixels wide there; "up to 100 mm" is read as one standard deviation.',
    ),
    Claim(
        "error of the orientation beyond 3 m (rad, one standard deviation)", "section 5.2", "0.05",
        _PIXELS,
    ),
    Claim(
        "distance beyond 3 m: error of the thesis's filter over that of a sighting", "chapter 6",
        "< 1", "The filter smooths what a few pixels say about the distance.", below_one,
    ),
    Claim(
        "orientation beyond 3 m: error of the thesis's filter over that of a sighting", "chapter 6",
        "< 1", "With R = .05 and no control input, the estimate lags behind every turn of the "
        "robot, while the sighting itself is nearly exact.", below_one,
    ),
    *(
        Claim(f"mean NIS (2 is right), {name} Kalman filter", "section 5.2", None, why)
        for name, why in (
            ("consistent", "Measured settings: innovations are as large as the filter expects."),
            ("thesis", "Without control input the filter is surprised by every footstep."),
        )
    ),
    *(
        Claim(quantity, "section 5.2.1", printed, _CONFIGURED)
        for quantity, printed in (
            ("scaling: middle of the distance (mm)", "2150"),
            ("scaling: half the interval of the distance (mm)", "1950"),
            ("scaling: factor of the orientation", "2"),
        )
    ),
    Claim(
        "largest norm of a scaled pattern", "section 4.2.1", "1",
        "Each entry is in [-1, 1], so norms run from 0 to 1.41: the patterns are scaled, not "
        "normalized.", lambda values: band(values)[1] <= 1, wrong=True,
    ),
    Claim("angular templates, vigilance 0.95", "figure 5.9", None,
          "The thesis draws them and prints no number."),
    Claim(
        "distance within a category: angular at 0.95 minus Euclidean at 0.1 (mm)", "section 5.2.1",
        "> 0", "An angle about the middle of the view cannot tell near from far.", above_zero,
    ),
    *(
        Claim(f"centers, vigilance {rho}", f"figure {figure}", printed, _RECIPE)
        for rho, figure, printed in (
            ("0.15", "5.10", "137"), ("0.1", "5.11", "333"), ("0.075", "5.12", "519"),
            ("0.05", "5.13", "825"), ("0.025", "5.14", "1933"),
        )
    ),
    *(
        Claim(quantity, "section 5.2.2", printed, _CONFIGURED)
        for quantity, printed in (
            ("ball reached within (mm)", "500"), ("reward for reaching the ball", "100"),
            ("reward for reaching it straight", "150"), ("straight within (rad)", "0.05"),
        )
    ),
    Claim(
        "states, ARKAQ, vigilance 0.1", "figure 5.16", "333",
        "The agent's states come from the same recipe as figure 5.11, on filtered estimates of "
        "a stream of its own, so they miss the number in the same way.",
    ),
    Claim(
        "states at the left edge that turn left (%)", "figure 5.16", "> 50",
        "There a turn to the left brings the ball to the middle.",
        lambda values: band(values)[0] > 50,
    ),
    Claim(
        "walks that reach the ball, of eleven", "figures 5.17-5.30", "11",
        "The starts are ours, since the thesis prints none.",
    ),
    Claim(
        "way walked over straight way: vigilance 0.15 minus 0.05", "section 5.2.2", "> 0",
        '"More states, straighter": the walks of all of them are nearly straight, so there is '
        "little that more states could gain.", above_zero,
        of=_minus("way walked over straight way (median), ARKAQ, vigilance 0.15",
                  "way walked over straight way (median), ARKAQ, vigilance 0.05"),
    ),
    Claim(
        "reward: vigilance 0.1 minus 0.025", "chapter 6", "> 0",
        '"More states are not better": the more states there are, the more rarely each is '
        "visited, and the less is learned of it.", above_zero,
        of=_minus("reward, ARKAQ, vigilance 0.1", "reward, ARKAQ, vigilance 0.025"),
    ),
    Claim(
        _BEST, "chapter 6", "footsteps along × across",
        "Footsteps of 100 mm and .1 rad divide the view into 39 × 10 pieces, so about 390 states "
        "would be best; the band shows how much the best of five numbers changes with the seed.",
        lambda values: band(values)[0] <= computed()["footsteps along times across"]
        <= band(values)[1],
        of=_best_states,
    ),
    *(
        Claim(f"{what}, {who}", "section 5.2.2", None, _OWN)
        for what in ("ball reached (%)", "+50 earned (%)", "way walked over straight way (median)")
        for who in (
            "ARKAQ, consistent Kalman filter", "ARKAQ, thesis Kalman filter",
            "planner that sees the truth", "random actions",
        )
    ),
    Claim("reward of a goal", "section 5.3", "100", _CONFIGURED),
    Claim("reward of a miss", "section 5.3", "-100", _CONFIGURED),
    *(
        Claim(f"goal centers, vigilance {rho}", f"figure {figure}", printed, _ISLANDS)
        for rho, figure, printed in (
            ("0.075", "5.35", "9"), ("0.06", "5.36", "13"), ("0.05", "5.37", "18"),
        )
    ),
    Claim("states, ARKAQ that scores, near", "figure 5.39", "13", _ISLANDS),
    Claim("goals (%), near, ARKAQ", "figure 5.40", "60",
          _NEWER + " Kicks are calibrated on those of a real robot."),
    Claim(
        "goals (%), near, random actions", "figure 5.40", "35",
        "The distance of the goal was chosen so that random actions score as often as printed.",
    ),
    Claim(
        "goals in the first 100 kicks (%), near: ARKAQ minus random actions", "section 5.3.2",
        "about 0", "At first ARKAQ explores, which is to act at random.", around_zero,
    ),
    Claim(
        "goals (%), near: the last 200 kicks minus the first 100", "section 5.3.2", "> 0",
        "It exploits what it has learned.", above_zero,
    ),
    Claim(
        "goals (%), random actions: near minus far", "section 5.3.2", "> 0",
        "From farther away the goal is narrower and kicks stray farther.", above_zero,
        of=_minus("goals (%), near, random actions", "goals (%), far, random actions"),
    ),
    Claim(
        "goals (%), far: ARKAQ minus random actions", "figure 5.41", "> 0",
        "An unlucky run ends with a policy that hardly kicks; see `goal.train`.", above_zero,
        of=_minus("goals (%), far, ARKAQ", "goals (%), far, random actions"),
    ),
    *(
        Claim(f"goals (%), {place}, {who}", figure, None,
              "It turns until it aims as well as turns allow, then kicks."
              if who.startswith("planner") else "The thesis draws a curve and prints no number.")
        for place, figure, names in (
            ("near", "figure 5.40", ("planner that sees the truth",)),
            ("far", "figure 5.41", ("ARKAQ", "random actions", "planner that sees the truth")),
        )
        for who in names
    ),
    Claim(
        "numbers that one update of Q reads, 20 states, 3 actions", "chapter 6", "O(A S²): 1200",
        "O(A S²) is a sweep of value iteration; a step of Q-learning reads A + 1 values, and "
        "finding the state is O(S), or O(1) with an index.",
        lambda values: band(values)[0] >= 1200, wrong=True,
    ),
)  # fmt: skip

#: Every claim, in the thesis's order.
CLAIMS: tuple[Claim, ...] = (*_CHAPTER_2, *_CHAPTER_5)
