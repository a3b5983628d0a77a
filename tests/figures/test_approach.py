"""The figures of the ball problem: what is drawn is what was computed, and can be read."""

import itertools
import math
import re

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.path import Path as Polygon
from PIL import Image
from scipy import stats

from arkaq_edu.arkaq import Arkaq, TrainingSettings
from arkaq_edu.experiments import approach
from arkaq_edu.experiments.approach import TRAJECTORY_STARTS as STARTS
from arkaq_edu.experiments.approach import Trajectory, record_episode, trajectory
from arkaq_edu.field import Camera, Legs, World
from arkaq_edu.field.camera import FIELD_OF_VIEW
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures import FIGURES, draw, field
from arkaq_edu.figures import approach as figures
from arkaq_edu.figures.drawing import animation, style

BALL_PROBLEM = ["5.3", "5.5", "5.6", "5.7", "5.8", *(f"5.{n}" for n in range(10, 31))]
IN_VIEW = {17: 1, 18: 2, 19: 3, 20: 4, 21: 5, 22: 6, 24: 7, 25: 8, 26: 9, 28: 10, 30: 11}
FROM_ABOVE = {23: 6, 27: 9, 29: 10}


@pytest.fixture(scope="module")
def agent():
    return approach.load_agent()


def fresh_axes():
    return Figure(layout="constrained").subplots()


# The gallery


def test_the_gallery_holds_every_figure_of_the_ball_problem_in_order():
    numbers = [tuple(map(int, number.split("."))) for number in FIGURES]
    assert set(BALL_PROBLEM) <= set(FIGURES) and numbers == sorted(numbers)
    for number, function in FIGURES.items():
        assert function.__name__ == "figure_" + number.replace(".", "_")
        assert f"figure {number}," in function.__doc__ or f"figure {number}:" in function.__doc__


@pytest.mark.parametrize("number", BALL_PROBLEM)
def test_a_figure_draws_where_it_is_told_and_states_a_fact(number, monkeypatch):
    monkeypatch.setattr(plt, "subplots", lambda *_, **__: pytest.fail("opened a window"))
    monkeypatch.setattr(plt, "show", lambda *_: pytest.fail("showed itself"))
    ax = fresh_axes()
    plot = FIGURES[number](ax)
    assert plot.ax is ax
    assert repr(plot) and "object at" not in repr(plot) and "array" not in repr(plot)
    for drawn in [ax, *ax.child_axes]:
        labels = drawn.get_xlabel() + drawn.get_ylabel()
        measured = any(unit in labels for unit in ("(mm)", "(rad)", "(pixel)"))
        assert measured == drawn.axison, "what has axes has units"
    ax.figure.canvas.draw()
    (left, _), (right, top) = ax.figure.bbox.get_points()
    title = ax.get_title(loc="left") and ax._left_title.get_window_extent()
    assert not title or (left <= title.x0 and title.x1 <= right and title.y1 <= top)


def test_draw_keeps_a_picture_and_opens_nothing(tmp_path):
    before = plt.get_fignums()
    plot = draw("5.7", tmp_path / "sight.png")
    assert plt.imread(tmp_path / "sight.png").std() > 0.05, "not an empty page"
    assert repr(plot) == repr(field.figure_5_7(fresh_axes()))
    assert plt.get_fignums() == before
    assert draw("5.7").ax.figure.number in plt.get_fignums()
    plt.close("all")


@pytest.mark.parametrize("number", ["5.99", "", "figure_5_10", 5.7])
def test_draw_names_the_figures_there_are(number):
    with pytest.raises(ValueError, match=r"number must be one of .*5\.10, .*got " + repr(number)):
        draw(number)


# The field: 5.3, 5.5, 5.7, 5.8


def test_the_camera_picture_is_the_cameras_and_the_title_what_it_sees():
    world = World(rng=0)
    world.reset((-1000.0, 300.0, 0.2), (500.0, 400.0))
    plot = field.figure_5_3(fresh_axes(), world=world)
    assert np.array_equal(plot.image.get_array(), Camera().picture(world))
    seen, true = Camera().sighting(world), world.ball_from_robot()
    assert repr(plot) == (
        f"seen: {seen[0]:,.0f} mm, {seen[1]:+.3f} rad; true: {true[0]:,.0f} mm, {true[1]:+.3f} rad"
    )
    world.reset((-1000.0, 300.0, 0.2), (-1500.0, 300.0))
    assert repr(field.figure_5_3(fresh_axes(), world=world)).startswith("seen: no ball; true: 500")


def test_the_drift_of_a_straight_walk_is_that_of_the_gait():
    plot = field.figure_5_5(fresh_axes(), cycles=20, n=200, rng=3)
    gait, s = Legs(), np.linspace(0, 2000, 20001)
    # The body goes ahead by ds and to the left by slide ds, while it turns by pull ds.
    heading = gait.pull * s
    x = np.trapezoid(np.cos(heading) - gait.slide * np.sin(heading), s)
    y = np.trapezoid(np.sin(heading) + gait.slide * np.cos(heading), s)
    walked = np.array(plot.walked.get_data())
    assert walked[:, -1] == pytest.approx([x, y], abs=3) and y > 0 > heading[-1]
    assert f"{y:.0f} mm to the left, turned {-heading[-1]:.3f} rad to the right" in repr(plot)
    straight = np.array(plot.straight.get_data())
    assert straight[0] == pytest.approx(100 * np.arange(21), abs=3)
    assert np.abs(straight[1]).max() < 1e-6
    ends = np.array([segment[-1] for segment in plot.walks.get_segments()])
    assert len(ends) == 200 and ends[:, 1].std() > 20
    assert ends.mean(axis=0) == pytest.approx([x, y], abs=4 * ends[:, 1].std() / 200**0.5 + 3)
    assert len(plot.bodies.get_paths()) == len(plot.reference.get_paths()) == 5


def test_a_body_is_as_large_as_the_robot_and_looks_where_it_looks():
    outline = field.body_outline(100.0, -50.0, 0.7)
    ahead, left = np.array([np.cos(0.7), np.sin(0.7)]), np.array([-np.sin(0.7), np.cos(0.7)])
    offsets = outline - [100.0, -50.0]
    assert np.ptp(offsets @ ahead) == pytest.approx(317)
    assert np.ptp(offsets @ left) == pytest.approx(180)
    assert offsets[-1] == pytest.approx(158.5 * ahead), "the nose comes last"
    assert Polygon(outline).contains_point((100.0, -50.0))


def test_the_field_is_drawn_to_scale_and_the_view_is_lit():
    plot = field.figure_5_7(fresh_axes())
    assert tuple(plot.image.get_extent()) == EXTENT
    picture = np.asarray(plot.image.get_array(), dtype=float).sum(axis=2)
    rows, cols = picture.shape

    def brightness(distance, orientation):
        x, y = -2500 + distance * math.cos(orientation), distance * math.sin(orientation)
        return picture[int((2000 - y) / 4000 * rows), int((x + 3000) / 6000 * cols)]

    half = FIELD_OF_VIEW / 2
    for side in (-1, 1):
        inside, outside = side * (half - 0.02), side * (half + 0.02)
        for distance in (1200, 2000, 3500):
            assert brightness(distance, inside) > brightness(distance, outside) + 30
    assert brightness(4000, 0.2) > brightness(4200, 0.2) + 30, "and ends at 4,100 mm"


def test_eq_5_1_is_even_in_depth_and_the_other_on_the_field():
    plot = field.figure_5_8(fresh_axes(), n=2000, rng=5)
    for marks in (plot.thesis, plot.area):
        aside, ahead = marks.get_data()
        assert np.abs(np.arctan2(aside, ahead)).max() <= FIELD_OF_VIEW / 2
        distance = np.hypot(aside, ahead)
        assert distance.min() >= 200 and distance.max() <= 4100
        assert f"{(distance < 1000).mean():.0%} within 1 m" in repr(plot)
    depth = plot.thesis.get_ydata()
    # Away from where the arc of 200 and of 4,100 mm cuts depths short.
    middle = depth[(depth > 250) & (depth < 3500)]
    assert stats.kstest(middle, stats.uniform(250, 3250).cdf).pvalue > 0.01
    squares = (np.array(plot.area.get_data()) ** 2).sum(axis=0)
    uniform = stats.uniform(200**2, 4100**2 - 200**2)
    assert stats.kstest(squares, uniform.cdf).pvalue > 0.01


# The policy: 5.16


def test_the_map_of_actions_is_the_greedy_policy(agent):
    plot = figures.figure_5_16(fresh_axes(), agent=agent)
    places = agent.sensing.unscale(agent.art.cluster_centers_)
    for state, (distance, orientation) in enumerate(places):
        action = ("forward", "left", "right")[int(np.argmax(agent.q.Q[state]))]
        x, y = plot.marks[action].get_data()
        assert np.min(np.hypot(x - orientation, y - distance)) < 1e-9
    assert sum(len(marks.get_xdata()) for marks in plot.marks.values()) == len(places)
    assert f"{len(places)} states (thesis 333) at vigilance 0.1" in repr(plot)
    assert plot.ax.get_xlim()[0] > plot.ax.get_xlim()[1], "left is left"


def test_an_action_has_a_color_and_a_direction_of_its_own():
    plot = figures.plot_policy([[0, -0.5], [0, 0], [0, 0.5]], [2, 0, 1], fresh_axes())
    for action, marks in plot.marks.items():
        assert to_hex(marks.get_color()) == style.ACTIONS[action]
        assert marks.get_label() == action
    tips = {a: figures.MARKERS[a].vertices[3] for a in plot.marks}
    assert tips["forward"] == pytest.approx([0, 1])
    assert tips["left"] == pytest.approx([-1, 0]) and tips["right"] == pytest.approx([1, 0])
    shades = [to_hex(color) for color in plot.cells.get_facecolors()]
    assert shades == [style.ACTIONS[action] for action in ("right", "forward", "left")]


@pytest.mark.parametrize(
    ("actions", "message"), [([0], "actions must have shape"), ([0, 3], "0, 1 or 2, got")]
)
def test_the_map_of_actions_refuses_others(actions, message):
    with pytest.raises(ValueError, match=message):
        figures.plot_policy([[0, 0], [0.5, 0.5]], actions, fresh_axes())


def test_an_agent_without_values_has_no_map():
    with pytest.raises(ValueError, match="agent must have learned"):
        figures.figure_5_16(fresh_axes(), agent=Arkaq(rng=0))


def test_the_learning_curve_is_the_mean_of_the_last_episodes():
    agent = Arkaq(rng=0, learning=TrainingSettings(exploration=11, exploitation=20))
    rows = [(3, 0.0), (4, 100.0), (5, 150.0), (2, 50.0)]
    agent.history = [("segmentation", 9, 150.0, True)]
    agent.history += [("Q-learning", cycles, reward, reward > 0) for cycles, reward in rows]
    plot = figures.plot_learning(agent, fresh_axes(), window=2)
    assert plot.curve.get_xdata().tolist() == [7, 12, 14]
    assert plot.curve.get_ydata() == pytest.approx([50, 125, 100])
    assert set(plot.switch.get_xdata()) == {11}
    assert repr(plot) == "reward of 2 episodes: 50 at first, 100 at the end"
    with pytest.raises(ValueError, match="window must be"):
        figures.plot_learning(agent, fresh_axes(), window=5)


# The trajectories: 5.17 to 5.30


@pytest.mark.thesis("figures 5.17 to 5.22, 5.24 to 5.26, 5.28 and 5.30")
@pytest.mark.parametrize(("number", "start"), IN_VIEW.items())
def test_a_trajectory_in_view_is_the_walk_from_its_start(number, start, agent):
    plot = FIGURES[f"5.{number}"](fresh_axes(), agent=agent)
    looks = record_episode(agent, *STARTS[start - 1]).table
    assert np.column_stack(plot.truth.get_data()) == pytest.approx(
        looks[["orientation", "distance"]].to_numpy()
    )
    assert plot.truth.get_xdata()[0] == pytest.approx(STARTS[start - 1][1])
    assert plot.sightings.get_markerfacecolor() == "none", "a measurement is hollow"
    assert np.column_stack(plot.sightings.get_data()) == pytest.approx(
        looks[["seen_orientation", "seen_distance"]].to_numpy(), nan_ok=True
    )
    for code, action in enumerate(("forward", "left", "right")):
        then = looks[looks.action == code]
        assert plot.estimates[action].get_ydata() == pytest.approx(then.estimated_distance)
    assert f"trajectory {start}, from {STARTS[start - 1][0]:,.0f} mm" in repr(plot)


@pytest.mark.thesis("figures 5.23, 5.27 and 5.29")
@pytest.mark.parametrize(("number", "start"), FROM_ABOVE.items())
def test_a_trajectory_from_above_leads_from_the_start_to_the_ball(number, start, agent):
    plot = FIGURES[f"5.{number}"](fresh_axes(), agent=agent)
    walked = record_episode(agent, *STARTS[start - 1])
    xy = np.column_stack(plot.path.get_data())
    assert xy == pytest.approx(walked.table[["x", "y"]].to_numpy())
    distance, orientation = STARTS[start - 1]
    ball = xy[0] + distance * np.array([np.cos(orientation), np.sin(orientation)])
    assert np.column_stack(plot.straight.get_data())[-1] == pytest.approx(ball)
    length = np.linalg.norm(np.diff(xy, axis=0), axis=1).sum()
    detour = length / (distance - np.linalg.norm(ball - xy[-1]))
    assert f"{detour:.2f} × the straight line, +{walked.reward:g}" in repr(plot)
    assert len(plot.bodies.get_paths()) == len(range(0, len(xy) - 1, 5))


def test_a_walk_that_fails_says_so(agent):
    table = record_episode(agent, *STARTS[0]).table.iloc[:3]
    lost = Trajectory(pd.DataFrame(table), False, 0.0)
    for plot in (figures.plot_view, figures.plot_above):
        assert "the ball is not reached" in repr(plot(lost, fresh_axes()))


@pytest.mark.parametrize("number", [0, 12, 1.5])
def test_there_are_eleven_trajectories(number):
    with pytest.raises(ValueError, match=r"number must be"):
        trajectory(number)


# The moving picture


@pytest.fixture(scope="module")
def short_walk(agent):
    """The end of a walk: a few looks, of which one shows nothing."""
    walked = record_episode(agent, *STARTS[0])
    table = walked.table.iloc[-4:].reset_index(drop=True)
    table.loc[1, ["seen_distance", "seen_orientation"]] = np.nan
    return Trajectory(table, walked.is_success, walked.reward)


def test_marks_on_the_field_are_where_the_ball_was_seen_and_believed(short_walk):
    table = short_walk.table.assign(heading=lambda looks: looks.heading + 0.3)
    moved = Trajectory(table, True, 100.0)
    walking = animation.animate(moved)
    walking._draw_was_started = True  # it is drawn here frame by frame
    for number, look in table.iterrows():
        walking._draw_frame(number)
        ring, cross = walking._fig.axes[0].lines
        for mark, kind in ((ring, "seen"), (cross, "estimated")):
            x, y = mark.get_xdata()[0] - look.x, mark.get_ydata()[0] - look.y
            ahead = x * np.cos(look.heading) + y * np.sin(look.heading)
            left = y * np.cos(look.heading) - x * np.sin(look.heading)
            place = look[f"{kind}_distance"], look[f"{kind}_orientation"]
            assert [np.hypot(ahead, left), np.arctan2(left, ahead)] == pytest.approx(
                place, nan_ok=True
            )
        assert ring.get_markerfacecolor() == "none", "a measurement is hollow"
        assert animation.caption_at(moved, number) in [t.get_text() for t in walking._fig.texts]


def test_a_caption_says_what_was_seen_believed_and_done(short_walk):
    first, blind, _, last = (animation.caption_at(short_walk, look) for look in range(4))
    look = short_walk.table.iloc[0]
    assert f"seen {look.seen_distance:5,.0f} mm, {look.seen_orientation:+.2f} rad" in first
    assert f"estimate {look.estimated_distance:5,.0f} mm" in first
    action = ("forward", "left", "right")[int(look.action)]
    assert f"cycle 0: state {look.category:.0f}, so {action}" in first
    assert blind.startswith("nothing seen; estimate")
    assert last.endswith(f"cycle 3: reached, +{short_walk.reward:g}")
    lost = Trajectory(short_walk.table, False, 0.0)
    assert animation.caption_at(lost, 3).endswith("the ball is lost")


def frames_of(path):
    with Image.open(path) as picture:
        frames = []
        for number in range(picture.n_frames):
            picture.seek(number)
            frames.append(np.asarray(picture.convert("RGB"), dtype=float))
    return frames


def test_a_walk_is_kept_as_a_small_gif_with_a_frame_a_look(short_walk, tmp_path):
    animation.save_film(short_walk, tmp_path / "walk.GIF")
    frames = frames_of(tmp_path / "walk.GIF")
    assert len(frames) == len(short_walk.table)
    assert min(abs(b - a).max() for a, b in itertools.pairwise(frames)) > 50, "it moves"
    assert (tmp_path / "walk.GIF").stat().st_size / len(frames) * 40 < 3e6
    with Image.open(tmp_path / "walk.GIF") as film:
        assert "loop" not in film.info, "it plays once"


def test_a_walk_is_kept_as_a_page_that_needs_no_network(short_walk, tmp_path):
    pages = [tmp_path / name for name in ("one.html", "two.html")]
    for page in pages:
        animation.save_film(short_walk, page)
    text = pages[0].read_text()
    assert text.count("data:image/png;base64") == len(short_walk.table)
    assert "http" not in text and "<link" not in text
    for icon in set(re.findall(r'class="fa fa-([a-z-]+)', text)):
        assert f".fa-{icon}::before" in text, "every button has its sign"
    assert pages[0].read_bytes() == pages[1].read_bytes()


def test_a_walk_moves_in_a_notebook(short_walk, tmp_path):
    moving = animation.Film(short_walk)
    (tmp_path / "walk.png").write_bytes(moving._repr_png_())
    assert len(frames_of(tmp_path / "walk.png")) == len(short_walk.table)
    with Image.open(tmp_path / "walk.png") as film:
        assert film.info["loop"] == 1, "it plays once"
    assert repr(moving) == short_walk.summary


@pytest.mark.parametrize("name", ["walk.mp4", "walk", "gif", ".html"])
def test_other_endings_are_refused_before_anything_is_drawn(name, tmp_path, monkeypatch):
    monkeypatch.setattr(animation, "animate", lambda _: pytest.fail("drew"))
    with pytest.raises(ValueError, match=r"path must end in \.gif or \.html, got"):
        animation.save_film(None, tmp_path / name)
    assert not list(tmp_path.iterdir())
