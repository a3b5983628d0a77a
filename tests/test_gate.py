"""Every public callable that takes numbers, called with good input and with bad.

`CALLS` holds one good call of each. A test fails if a public callable is in neither `CALLS` nor
`TAKES_NO_NUMBERS`, so a new one cannot be forgotten.
"""

import copy
import dataclasses
import importlib
import inspect
import math

import numpy as np
import pandas as pd
import pytest

import arkaq_edu as ae
from arkaq_edu import (
    arkaq,
    art,
    exercises,
    experiments,
    field,
    figures,
    kalman,
    mdp,
    pomdp,
    widgets,
)
from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import approach, goal

ROOMS = (
    "kalman", "art", "mdp", "pomdp", "field", "arkaq", "envs", "experiments",
    "experiments.approach", "experiments.goal", "figures", "widgets", "exercises",
)  # fmt: skip

EYE = np.eye(2)
Z = np.array([[1.0, 2.0], [2.0, 1.0], [3.0, 0.5]])
FILTER = {"A": EYE, "H": EYE, "Q": 0.1 * EYE, "R": EYE}
T = np.array([[[0.9, 0.1], [0.2, 0.8]], [[0.5, 0.5], [0.5, 0.5]]])
R = np.array([[1.0, 0.0], [0.0, 2.0]])
O = np.array([[[0.8, 0.2], [0.3, 0.7]]] * 2)  # noqa: E741
B = np.array([0.4, 0.6])
MODEL = mdp.MDP(T, R, 0.9)
HIDDEN = pomdp.POMDP(T, O, R, 0.9)
VALUES = pomdp.solve_pomdp(HIDDEN, horizon=2)
TREES = np.array([[1.0, 0.0], [0.0, 1.0], [0.4, 0.4]])
EPISODE = mdp.Episode(np.array([0, 1, 0]), np.array([0, 1]), np.array([1.0, 2.0]), True)
PATTERNS = np.random.default_rng(0).uniform(-1, 1, (20, 2))
NETWORK = art.EuclideanART(0.3).fit(PATTERNS)
ONE = np.eye(1)
SENSING = {
    "low": (-0.5,), "high": (0.5,), "A": ONE, "H": ONE, "Q": 0.1 * ONE, "R": ONE, "P0": ONE,
    "B": np.array([[0.1, -0.1]]), "range_noise": 0.0,
}  # fmt: skip
ANGLES = np.linspace(-0.4, 0.4, 5)


def shows(explorer):
    """What an explorer states at first."""
    return lambda **given: repr(explorer(**given))


def figure(number, **good):
    """A figure of the thesis, by its number, with what it takes."""
    return lambda **given: figures.draw(number, **given), good


#: One good call of each public callable: the callable, and its arguments by name.
CALLS = {
    "kalman.KalmanFilter": (kalman.KalmanFilter, FILTER | {"x0": B, "P0": EYE, "gate": 0.99}),
    "kalman.KalmanFilter.predict": (
        lambda u: kalman.KalmanFilter(**FILTER, B=EYE).predict(u), {"u": B}),
    "kalman.KalmanFilter.update": (
        lambda z, R: kalman.KalmanFilter(**FILTER).update(z, R), {"z": B, "R": EYE}),
    "kalman.KalmanFilter.filter": (
        lambda Z, U: kalman.KalmanFilter(**FILTER, B=EYE).filter(Z, U).x, {"Z": Z, "U": Z}),
    "kalman.kalman_batch": (kalman.kalman_batch, FILTER | {"Z": Z[None], "x0": B, "P0": EYE}),
    "kalman.chi_square_band": (kalman.chi_square_band, {"dof": 2, "count": 3, "probability": 0.9}),
    "kalman.constant_velocity": (kalman.constant_velocity, {"dt": 0.5, "n_axes": 2}),
    "art.ART1": (lambda vigilance, L: art.ART1(vigilance, L).fit(PATTERNS > 0),
                 {"vigilance": 0.5, "L": 2.0}),
    "art.ART2": (lambda **p: art.ART2(**p).fit(np.abs(PATTERNS)),
                 {"vigilance": 0.9, "a": 10.0, "b": 10.0, "c": 0.1, "d": 0.9, "theta": 0.1}),
    "art.ART2A": (lambda **p: art.ART2A(**p).fit(np.abs(PATTERNS)),
                  {"vigilance": 0.9, "learning_rate": 0.5, "theta": 0.0}),
    "art.EuclideanART": (lambda **p: art.EuclideanART(**p).fit(PATTERNS),
                         {"vigilance": 0.3, "learning_rate": 0.5, "max_clusters": 5}),
    "art.EuclideanART.fit": (lambda X: art.EuclideanART(0.3).fit(X).cluster_centers_,
                             {"X": PATTERNS}),
    "art.coverage": (art.coverage, {"network": NETWORK, "patterns": PATTERNS}),
    "art.learn_letters": (art.learn_letters, {"vigilance": 0.5}),
    "art.learned_norm": (art.learned_norm, {"c": 0.1, "d": 0.9}),
    "art.match_norm": (art.match_norm, {"cosine": 0.5, "cdz": 0.3, "c": 0.1}),
    "art.reset_cosine": (art.reset_cosine, {"vigilance": 0.9, "cdz": 0.3, "c": 0.1}),
    "art.reset_fact": (art.reset_fact, {"c": 0.1, "d": 0.9, "vigilance": 0.9}),
    "mdp.Bandit": (mdp.Bandit, {"p": B}),
    "mdp.Boltzmann": (mdp.Boltzmann, {"temperature": 0.1}),
    "mdp.EpsilonGreedy": (mdp.EpsilonGreedy, {"epsilon": 0.1}),
    "mdp.UCB": (mdp.UCB, {"c": 1.4}),
    "mdp.Exponential": (mdp.Exponential, {"start": 2.0, "half_life": 3.0, "floor": 0.1}),
    "mdp.Power": (mdp.Power, {"start": 1.0, "exponent": 0.6}),
    "mdp.MDP": (mdp.MDP, {"T": T, "R": R, "gamma": 0.9, "start": B}),
    "mdp.MDP.step": (MODEL.step, {"s": 0, "a": 1, "rng": 0}),
    "mdp.QLearner": (mdp.QLearner, {
        "n_states": 2, "n_actions": 2, "alpha": 0.5, "gamma": 0.9, "initial": 0.0, "rng": 0}),
    "mdp.QLearner.update": (
        lambda **x: mdp.QLearner(2, 2, 0.5, 0.9).update(**x),
        {"s": 0, "a": 1, "r": 1.0, "s_next": 1, "n_steps": 2}),
    "mdp.QLearner.boltzmann": (
        lambda s, temperature: mdp.QLearner(2, 2, 0.5, 0.9, rng=0).boltzmann(s, temperature),
        {"s": 0, "temperature": 1.0}),
    "mdp.argmax_shared": (mdp.argmax_shared, {"values": R, "rng": 0}),
    "mdp.best_actions": (mdp.best_actions, {"Q": R, "slack": 1e-9}),
    "mdp.delayed_rewards": (mdp.delayed_rewards, {
        "delays": (2, 3), "rewards": (1.0, 2.0), "gamma": 0.9}),
    "mdp.discounted_returns": (mdp.discounted_returns, {"r": B, "gamma": 0.9}),
    "mdp.earnings": (mdp.earnings, {"horizon": 5, "gamma": 0.9}),
    "mdp.error_bound": (mdp.error_bound, {"mdp": MODEL, "values": B}),
    "mdp.finite_horizon": (mdp.finite_horizon, {"mdp": MODEL, "horizon": 5, "gamma": 1.0}),
    "mdp.grid_world": (mdp.grid_world, {"slip": 0.1, "gamma": 0.9}),
    "mdp.monte_carlo": (mdp.monte_carlo, {
        "episodes": [EPISODE], "n_states": 2, "gamma": 0.9, "alpha": 0.1, "initial": 0.0}),
    "mdp.td0": (mdp.td0, {
        "episodes": [EPISODE], "n_states": 2, "gamma": 0.9, "alpha": 0.1, "initial": 0.0}),
    "mdp.play": (mdp.play, {
        "bandit": mdp.Bandit(B), "strategy": mdp.Random(), "pulls": 5, "players": 2, "rng": 0}),
    "mdp.policy_evaluation": (mdp.policy_evaluation, {"mdp": MODEL, "policy": np.array([0, 1])}),
    "mdp.policy_chances": (mdp.policy_chances, {"mdp": MODEL, "policy": np.array([0, 1])}),
    "mdp.policy_model": (mdp.policy_model, {"mdp": MODEL, "policy": np.array([0, 1])}),
    "mdp.quality_of_convergence": (mdp.quality_of_convergence, {
        "earned": B, "optimal": 1.0, "baseline": 0.0, "last": 2}),
    "mdp.speed_of_convergence": (mdp.speed_of_convergence, {
        "earned": B, "target": 0.5, "window": 1}),
    "mdp.regret": (mdp.regret, {"earned": B, "optimal": 1.0}),
    "mdp.best_chains": (mdp.best_chains, {"earned": np.array([1.0, 2.0, 0.5])}),
    "mdp.simulate": (mdp.simulate, {
        "mdp": MODEL, "policy": np.array([0, 1]), "max_steps": 5, "rng": 0}),
    "mdp.softmax": (mdp.softmax, {"values": B, "temperature": 1.0}),
    "mdp.train": (
        lambda n_steps, temperature: mdp.train(
            MODEL, mdp.QLearner(2, 2, 0.5, 0.9, rng=0), n_steps, temperature=temperature),
        {"n_steps": 5, "temperature": 1.0}),
    "mdp.value_iteration": (
        lambda tol, horizon: mdp.value_iteration(MODEL, tol, horizon), {"tol": 1e-6, "horizon": 5}),
    "pomdp.POMDP": (pomdp.POMDP, {"T": T, "O": O, "R": R, "gamma": 0.9, "start": B}),
    "pomdp.ValueFunction.value": (VALUES.value, {"b": B}),
    "pomdp.ValueFunction.action": (VALUES.action, {"b": B}),
    "pomdp.belief_update": (pomdp.belief_update, {"pomdp": HIDDEN, "b": B, "a": 0, "z": 1}),
    "pomdp.bellman_error": (pomdp.bellman_error, {"pomdp": HIDDEN, "V": VALUES, "tol": 0.0}),
    "pomdp.calibration": (pomdp.calibration, {
        "claims": np.array([[0.2, 0.8], [0.6, 0.4]]), "true": np.array([[0, 1], [1, 0]]),
        "edges": np.array([0.0, 0.5, 1.0])}),
    "pomdp.dominated": (pomdp.dominated, {"alphas": TREES, "tol": 1e-9}),
    "pomdp.entropy": (pomdp.entropy, {"b": B}),
    "pomdp.expected_rewards": (pomdp.expected_rewards, {"pomdp": HIDDEN, "b": B}),
    "pomdp.predict": (pomdp.predict, {"pomdp": HIDDEN, "b": B, "a": 0}),
    "pomdp.prune": (pomdp.prune, {"alphas": TREES, "tol": 1e-9}),
    "pomdp.solve_pomdp": (
        lambda horizon, tol: pomdp.solve_pomdp(HIDDEN, horizon, tol), {"horizon": 2, "tol": 1e-3}),
    "pomdp.solve_point_based": (
        lambda tol, max_backups: pomdp.solve_point_based(HIDDEN, tol, max_backups),
        {"tol": 0.1, "max_backups": 5}),
    "pomdp.successors": (pomdp.successors, {"pomdp": HIDDEN, "b": B, "a": 0}),
    "pomdp.to_triangle": (pomdp.to_triangle, {"b": np.array([0.2, 0.3, 0.5])}),
    "pomdp.upper_surface": (pomdp.upper_surface, {"alphas": TREES}),
    "field.Camera": (field.Camera, {"height": 190.0, "tilt": 0.2, "min_pixels": 10}),
    "field.GoalSupervisor": (field.GoalSupervisor, {"distance": 1800.0}),
    "field.Head": (field.Head, {"reach": 1.6, "speed": 3.0, "settling": 0.1}),
    "field.Kick": (field.Kick, {"spread": 9.0, "swerve": 140.0}),
    "field.Legs": (field.Legs, {"slide": 0.07, "pull": -4e-5, "variation": 0.02}),
    "field.Supervisor": (field.Supervisor, {"near": 600.0, "far": 4100.0}),
    "field.World": (field.World, {"rng": 0}),
    "field.random_place": (field.random_place, {"rng": 0, "near": 200.0, "far": 4100.0}),
    "envs.BallApproachEnv": (ae.envs.BallApproachEnv, {
        "near": 600.0, "far": 4100.0, "patience": 10}),
    "envs.ScoreGoalEnv": (ae.envs.ScoreGoalEnv, {"goal_distance": 1800.0, "patience": 30}),
    "arkaq.Arkaq": (arkaq.Arkaq, {"vigilance": 0.1, "rng": 0}),
    "arkaq.Arkaq.act": (lambda observation: approach.load_agent().act(observation), {
        "observation": np.array([900.0, 0.1, 1.0])}),
    "arkaq.Sensing": (arkaq.Sensing, SENSING),
    "arkaq.TrainingSettings": (arkaq.TrainingSettings, dataclasses.asdict(TrainingSettings())),
    "arkaq.UniformGrid": (arkaq.UniformGrid, {"cells": (4, 2)}),
    "experiments.bands": (
        lambda digits: experiments.bands(experiments.load_study("planned"), digits=digits),
        {"digits": 1}),
    "experiments.count_centers": (experiments.count_centers, {
        "X": PATTERNS, "vigilances": (0.5, 0.3), "learning_rate": 0.5}),
    "experiments.learning_curve": (
        lambda window: experiments.learning_curve(approach.load_agent(), window), {"window": 50}),
    "experiments.record_kicks": (experiments.record_kicks, {"n": 1, "seed": 0}),
    "experiments.approach.at_random": (approach.at_random, {"seed": 0}),
    "experiments.approach.evaluate": (
        lambda **x: approach.evaluate(approach.at_random(), **x),
        {"n": 1, "seed": 0, "near": 600.0, "far": 700.0}),
    "experiments.approach.record_episode": (
        lambda **x: approach.record_episode(approach.load_agent(), **x),
        {"distance": 900.0, "orientation": 0.1, "seed": 0}),
    "experiments.approach.record_sightings": (
        approach.record_sightings, {"n": 5, "seed": 0, "period": 3}),
    "experiments.approach.train": (approach.train, {"seed": 0, "vigilance": 0.1}),
    "experiments.approach.trajectory": (approach.trajectory, {"number": 1}),
    "experiments.goal.at_random": (goal.at_random, {"seed": 0}),
    "experiments.goal.best_policy": (
        lambda patience: goal.best_policy("near", patience=patience), {"patience": 5}),
    "experiments.goal.cells": (
        lambda centers: goal.cells(centers)[0], {"centers": ANGLES[:, None]}),
    "experiments.goal.coverage": (goal.coverage, {"X": ANGLES[:, None], "width": 0.01}),
    "experiments.goal.curve": (goal.curve, {"scored": np.array([0.0, 1, 1, 0]), "block": 2}),
    "experiments.goal.evaluate": (
        lambda **x: goal.evaluate(goal.at_random(), **x),
        {"n": 1, "seed": 0, "goal_distance": 1850.0}),
    "experiments.goal.find_centers": (
        goal.find_centers, {"vigilance": 0.1, "X": ANGLES[:, None]}),
    "experiments.goal.kick_trials": (goal.kick_trials, {
        "goal_distance": 1850.0, "orientations": ANGLES[:1], "n": 1, "seed": 0}),
    "experiments.goal.make_look_around": (
        goal.make_look_around, {"goal_distance": 1850.0, "period": 5}),
    "experiments.goal.make_task": (goal.make_task, {"goal_distance": 1850.0}),
    "experiments.goal.record_episode": (
        lambda **x: goal.record_episode(goal.load_agent(), **x),
        {"orientation": 0.1, "goal_distance": 1850.0, "seed": 0}),
    "experiments.goal.record_sightings": (
        goal.record_sightings, {"n": 5, "seed": 0, "period": 3}),
    "experiments.goal.train": (
        goal.train, {"seed": 0, "vigilance": 0.1, "goal_distance": 1850.0}),
    "experiments.goal.usual_learning": (goal.usual_learning, {"goal_distance": 1850.0}),
    "experiments.goal.usual_vigilance": (goal.usual_vigilance, {"goal_distance": 1850.0}),
    "experiments.goal.count_fact": (goal.count_fact, {"n": 5, "vigilance": 0.1}),
    "figures.draw 2.2": figure("2.2", horizon=5, gamma=0.9),
    "figures.draw 2.8": figure("2.8", p=0.25),
    "figures.draw 2.13": figure("2.13", p=0.4),
    "figures.draw 2.14": figure("2.14", horizon=6),
    "figures.draw 2.15": figure("2.15", horizon=3),
    "figures.draw 2.16": figure("2.16", p=0.25),
    "figures.draw 2.21": figure("2.21", c=0.1, d=0.9, vigilance=0.95),
    "figures.draw 4.1": figure("4.1", vigilance=0.8, learning_rate=0.3, times=3),
    "figures.draw 4.2": figure("4.2", vigilance=0.4, learning_rate=0.5),
    "figures.draw 5.5": figure("5.5", cycles=20, n=12, rng=0),
    "figures.draw 5.8": figure("5.8", n=1000, rng=0),
    "figures.draw 5.32": figure("5.32", after=0.25),
    "widgets.belief_explorer": (widgets.belief_explorer, {"seed": 0}),
    "widgets.control_panel": (widgets.control_panel, {"seed": 0}),
    "widgets.scoring_explorer": (shows(widgets.scoring_explorer), {"patterns": ANGLES[:, None]}),
    "widgets.vigilance_explorer": (
        shows(widgets.vigilance_explorer), {"patterns": PATTERNS, "learning_rate": 0.6}),
}  # fmt: skip

#: Results, errors, and callables that are given only objects of ours, names or paths.
TAKES_NO_NUMBERS = set(
    [
        "kalman.KalmanTrace",
        "kalman.fit_noise",
        "art.quantization_error",
        "mdp.Episode",
        "mdp.Grid",
        "mdp.Held",
        "mdp.Play",
        "mdp.Random",
        "mdp.TrainingRun",
        "mdp.average_reward",
        "mdp.discounted",
        "mdp.example_mdp",
        "mdp.exploit",
        "mdp.explore",
        "mdp.hold",
        "mdp.policy_iteration",
        "mdp.modified_policy_iteration",
        "pomdp.BeliefAgent",
        "pomdp.Bowl",
        "pomdp.Calibration",
        "pomdp.Domination",
        "pomdp.PointBased",
        "pomdp.PolicyGraph",
        "pomdp.PolicyTree",
        "pomdp.PomdpFormatError",
        "pomdp.Successors",
        "pomdp.Trajectory",
        "pomdp.UpperBound",
        "pomdp.UpperSurface",
        "pomdp.ValueFunction",
        "pomdp.all_trees",
        "pomdp.bowl",
        "pomdp.problem",
        "pomdp.read_pomdp",
        "pomdp.regions",
        "pomdp.solved",
        "pomdp.trajectory",
        "pomdp.tree_value",
        "pomdp.write_pomdp",
        "field.GoalSighting",
        "field.Sighting",
        "field.Verdict",
        "field.bird_view",
        "envs.FullState",
        "envs.POMDPEnv",
        "envs.PixelObservation",
        "arkaq.Automaton",
        "arkaq.Estimator",
        "arkaq.ExpectedSarsa",
        "arkaq.Experience",
        "arkaq.Learner",
        "arkaq.QLearning",
        "arkaq.Sarsa",
        "arkaq.Segmenter",
        "arkaq.TableLearner",
        "experiments.agent_file",
        "experiments.goal_table",
        "experiments.load_kicks",
        "experiments.load_study",
        "experiments.mean_nis",
        "experiments.read_plan",
        "experiments.read_study",
        "experiments.goal.curves",
        "experiments.judge",
        "experiments.measure",  # its numbers, and those of results, go to the two studies
        "experiments.results",
        "experiments.study",
        "experiments.summary",
        "experiments.thesis_numbers",
        *(
            f"experiments.{task}.{name}"
            for task in ("approach", "goal")
            for name in (
                "calibrate", "describe", "greedy", "load_agent", "load_sightings", "load_study",
                "make_task", "mean_nis", "patterns", "planner", "score", "seed_runs", "study",
                "usual_learning", "usual_vigilance",
            )
        ),
        "experiments.approach.Stage",
        "experiments.approach.stages",
        "experiments.approach.Trajectory",
        "experiments.goal.BestPolicy",
        "experiments.goal.LookAround",
        "experiments.goal.Shot",
        "experiments.goal.load_center_counts",
        "experiments.goal.load_kick_trials",
        "experiments.goal.mean_curves",
        "experiments.goal.play",
        "experiments.goal.rates",
        "experiments.goal.scored_while_learning",
        "figures.Film",
        "figures.animate",
        "figures.draw",  # with each figure's own arguments above
        "figures.plot_study",
        "figures.save_film",
        "widgets.Buttons",
        "widgets.CanvasView",
        "widgets.Drag",
        "widgets.Explorer",
        *(f"widgets.{name}" for name in widgets.__all__ if name.islower()),
        # An exercise takes an answer; tests/exercises gives it the odd ones.
        "exercises.Exercise",
        "exercises.ExerciseError",
        "exercises.progress",
        *(f"exercises.{each.name}" for chapter in exercises.CHAPTERS.values() for each in chapter),
    ]
)  # fmt: skip

NEVER_A_NUMBER = {
    "NaN": math.nan, "text": "1", "bytes": b"1", "complex": 1j,
    "a date": np.datetime64("2026-01-01"), "an object": object(), "a function": len,
    "a dict": {"x": 1}, "a huge integer": 10**400,
    "a float beyond the bound": 1e200, "a ragged list": [[1.0], [1.0, 2.0]], "masked": np.ma.masked,
}  # fmt: skip
OPTIONAL = {  # arguments for which these words are good input
    ("kalman.KalmanFilter.update", "z"), ("kalman.KalmanFilter.filter", "Z"),
    ("kalman.kalman_batch", "Z"),
}  # fmt: skip
BOTH_WAYS = {("mdp.delayed_rewards", "delays")}

ARGUMENTS = [
    (name, argument)
    for name, (_, good) in CALLS.items()
    for argument, value in good.items()
    if isinstance(value, (int, float, np.ndarray, tuple))
]


def spoiled(value, bad):
    """Return a good value with one entry that is bad; for a scalar, the bad value itself."""
    if not isinstance(value, np.ndarray):
        return bad
    if isinstance(bad, list):
        return bad
    if bad is np.ma.masked:
        mask = np.zeros(value.shape, bool)
        mask.flat[0] = True
        return np.ma.masked_array(value, mask)
    entries = value.astype(object)
    entries.flat[0] = bad
    return entries.tolist()


def test_every_public_callable_is_called_here():
    public = {
        f"{room}.{name}"
        for room in ROOMS
        for name in importlib.import_module(f"arkaq_edu.{room}").__all__
        if callable(getattr(importlib.import_module(f"arkaq_edu.{room}"), name))
    }
    assert public - set(CALLS) - TAKES_NO_NUMBERS == set()


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
def test_what_is_not_a_number_is_refused_by_name(name, argument):
    call, good = CALLS[name]
    missed = {}
    for kind, bad in NEVER_A_NUMBER.items():
        if (name, argument) in OPTIONAL and kind in ("NaN", "masked"):
            continue
        if argument in ("alpha", "temperature", "epsilon") and kind == "a function":
            continue  # a schedule
        try:
            call(**copy.deepcopy(good) | {argument: spoiled(good[argument], bad)})
            missed[kind] = "accepted"
        except (ValueError, TypeError) as refusal:
            if argument not in str(refusal):
                missed[kind] = str(refusal)
    assert missed == {}


FORMS = {
    "lists": lambda x: x.tolist(),
    "columns first": np.asfortranarray,
    "every second entry": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "read-only": lambda x: np.frombuffer(x.tobytes(), x.dtype).reshape(x.shape),
    "swapped bytes": lambda x: x.astype(x.dtype.newbyteorder()),
    "nothing masked": np.ma.masked_array,
    "a frame": lambda x: pd.DataFrame(x) if x.ndim == 2 else x,
}


def told(result):
    """Return a result as text that shows every number in it."""
    if isinstance(result, (np.ndarray, float, int, str, bool, np.generic, list, tuple)):
        return repr(result)
    return (
        repr({k: v for k, v in vars(result).items() if "rng" not in k})
        if hasattr(result, "__dict__")
        else repr(result)
    )


@pytest.mark.parametrize("name", CALLS)
def test_the_form_of_an_array_changes_nothing(name):
    call, good = CALLS[name]
    arrays = {k: v for k, v in good.items() if isinstance(v, np.ndarray)}
    if not arrays:
        return
    with np.printoptions(threshold=10**6, precision=17):
        plain = told(call(**copy.deepcopy(good)))
        for form, change in FORMS.items():
            formed = {k: change(v) for k, v in arrays.items()}
            before = copy.deepcopy(formed)
            assert told(call(**good | formed)) == plain, form
            for argument in arrays:
                np.testing.assert_array_equal(formed[argument], before[argument])


def test_there_are_calls_for_every_room():
    assert {name.rpartition(".")[0].split(" ")[0] for name in CALLS} >= set(ROOMS) - {
        "figures",
        "exercises",
    }
    assert all(inspect.signature(call).parameters for call, _ in CALLS.values())
