"""The figures of the goal problem: what is drawn is what was computed."""

import io

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from arkaq_edu.arkaq import Arkaq
from arkaq_edu.art import EuclideanART
from arkaq_edu.envs.score_goal import ACTIONS
from arkaq_edu.experiments import approach, goal, thesis_numbers
from arkaq_edu.figures import FIGURES
from arkaq_edu.figures import goal as figures
from arkaq_edu.figures.approach import plot_learning
from arkaq_edu.figures.drawing import animation, style

GOAL_PROBLEM = [f"5.{n}" for n in (34, 35, 36, 37, 38, 39, 40, 41)]


def fresh_axes():
    return Figure(layout="constrained").subplots()


@pytest.fixture(scope="module")
def agent():
    return goal.load_agent()


@pytest.mark.parametrize("number", GOAL_PROBLEM)
def test_a_figure_draws_where_it_is_told_and_states_a_fact(number, monkeypatch):
    monkeypatch.setattr(plt, "subplots", lambda *_, **__: pytest.fail("opened a window"))
    ax = fresh_axes()
    plot = FIGURES[number](ax)
    assert plot.ax is ax and repr(plot) == ax.get_title(loc="left") != ""
    assert f"figure {number}," in FIGURES[number].__doc__
    ax.figure.canvas.draw()
    (left, _), (right, top) = ax.figure.bbox.get_points()
    title = ax._left_title.get_window_extent()
    assert left <= title.x0 and title.x1 <= right and title.y1 <= top


@pytest.mark.thesis("figures 5.35 to 5.37")
@pytest.mark.parametrize("vigilance", [0.075, 0.06, 0.05, 0.3])
def test_centers_stand_on_the_line_where_the_network_put_them(vigilance):
    stream = goal.patterns(goal.load_sightings())
    plot = figures.plot_segmentation(vigilance, fresh_axes())
    centers = EuclideanART(vigilance, 0.6).fit(stream).cluster_centers_.ravel() / 2
    assert sorted(plot.centers.get_xdata()) == pytest.approx(sorted(centers))
    assert repr(plot).startswith(f"{len(centers)} centers at vigilance {vigilance:g}")
    printed = thesis_numbers().get(f"goal centers, vigilance {vigilance:g}")
    assert ("the thesis printed" in repr(plot)) is (printed is not None)
    assert printed is None or repr(plot).endswith(f"printed {printed}")
    assert plot.ax.get_xlim() == (0.5, -0.5), "left is left"


def test_a_cell_is_where_its_center_is_the_nearest():
    centers = np.random.default_rng(0).uniform(-1, 1, (12, 1))
    middles, ends = goal.cells(centers)
    assert ends[0] == 0.5 and ends[-1] == -0.5 and (np.diff(ends) < 0).all()
    for place in np.random.default_rng(1).uniform(-0.5, 0.5, 200):
        mine = np.searchsorted(-ends, -place) - 1
        assert np.abs(middles - place).argmin() == mine


def test_the_stream_is_drawn_as_often_as_it_was_seen():
    X = goal.patterns(goal.load_sightings())
    plot = figures.figure_5_35(fresh_axes())
    tops, edges, base = plot.seen.get_data()
    counts, _ = np.histogram(X[np.abs(X) < 1] / 2, bins=edges)
    assert (tops - base) / (tops - base).max() == pytest.approx(counts / counts.max())


@pytest.mark.thesis("figure 5.39")
def test_every_state_shows_its_greedy_action_in_its_color(agent):
    plot = figures.figure_5_39(fresh_axes(), goal_agent=agent)
    centers, chosen = agent.art.cluster_centers_.ravel() / 2, agent.q.Q.argmax(axis=1)
    for number, action in enumerate(ACTIONS):
        expected = sorted(centers[chosen == number])
        assert sorted(plot.marks[action].get_xdata()) == pytest.approx(expected)
        name = figures.MARKS[action]
        assert to_hex(plot.marks[action].get_color()) == style.ACTIONS[name]
    assert f"{len(centers)} states (thesis 13) at vigilance 0.06" in repr(plot)
    # The lesson of the figure: turn to the goal, and kick where it is ahead.
    assert min(plot.marks["turn left"].get_xdata()) > max(plot.marks["turn right"].get_xdata())


@pytest.mark.parametrize("who", [Arkaq(task="goal"), approach.load_agent()])
def test_only_a_scorer_has_a_figure_5_39(who):
    with pytest.raises(ValueError, match="goal_agent must have learned to score"):
        figures.figure_5_39(fresh_axes(), goal_agent=who)


@pytest.mark.thesis("figures 5.40 and 5.41")
@pytest.mark.parametrize("distance", ["near", "far"])
def test_curves_are_means_and_bands_over_the_seeds(distance):
    study = goal.load_study()
    plot = figures.plot_scores(distance, fresh_axes())
    mine = study[study.goal_distance == distance]
    for who in ("ARKAQ", "random actions"):
        table = 2 * mine[mine.who == who].pivot(index="kicks", columns="seed", values="goals")
        mean, std = table.mean(axis=1), table.std(axis=1, ddof=0)
        assert plot.means[who].get_xdata().tolist() == table.index.tolist()
        assert plot.means[who].get_ydata() == pytest.approx(mean)
        corners = {tuple(np.round(c, 6)) for c in plot.bands[who].get_paths()[0].vertices}
        tops = zip(table.index, mean + std, strict=True)
        assert corners >= {tuple(np.round(c, 6)) for c in tops}
    limit = 100 * goal.best_policy(distance).goals
    assert plot.best.get_ydata() == pytest.approx([limit, limit])
    assert (plot.thesis is not None) == (distance == "near")
    if plot.thesis:
        assert plot.thesis.get_ydata().tolist() == [60, 35]
        assert plot.thesis.get_markerfacecolor() == "none"


def test_curves_of_another_study_are_drawn_as_well():
    rows = [
        ("near", seed, who, kicks, goals + seed)
        for seed in (0, 2)
        for who, goals in (("ARKAQ", 30), ("random actions", 10), ("oracle", 31))
        for kicks in (50, 100)
    ]
    table = pd.DataFrame(rows, columns=["goal_distance", "seed", "who", "kicks", "goals"])
    plot = figures.figure_5_40(fresh_axes(), study=table)
    assert plot.means["ARKAQ"].get_ydata().tolist() == [62, 62]
    assert plot.means["oracle"].get_ydata().tolist() == [64, 64]
    assert repr(plot) == "near: ARKAQ from 62 to 62 %, random actions from 22 to 22 %"


def test_the_film_of_a_shot_says_what_happened(agent, tmp_path):
    shot = goal.record_episode(agent, 0.3, seed=2)
    said = shot.summary
    assert said.startswith("the goal 0.30 rad left, 2 turns")
    assert said.endswith("a goal" if shot.is_success else "a miss")
    with pytest.raises(ValueError, match=r"\.gif or \.html"):
        animation.save_film(shot, tmp_path / "shot.avi")
    moving = animation.Film(shot)
    assert repr(moving) == said
    with Image.open(io.BytesIO(moving._repr_png_())) as film:
        # Frames that show the same become one, which stays longer.
        assert 10 < film.n_frames <= len(shot.frames)


def test_the_film_of_a_shot_shows_the_half_that_robot_and_goal_are_in(agent):
    shot = goal.record_episode(agent, 0.3, seed=2, goal_distance="far")
    film = animation.animate(shot)
    film._init_draw()  # a film that nobody has drawn warns
    (ax,) = film._fig.axes
    (low, high), (right, left) = ax.get_xlim(), ax.get_ylim()
    robot = 2700 - goal.STARTS["far"].distance
    assert 0 <= low < robot < 2700 < high == 3000
    assert right < -1900 and left > 1900  # no shot leaves it to a side


def test_a_punished_episode_is_not_cut_off(agent):
    plot = plot_learning(agent, Figure().subplots())
    low, high = plot.ax.get_ylim()
    rewards = plot.curve.get_ydata()
    assert low < rewards.min() < 0 < rewards.max() < high
