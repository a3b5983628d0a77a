"""The shape of value functions over two and three states: against brute force and against qhull."""

import itertools

import numpy as np
import pytest
from scipy.spatial import HalfspaceIntersection

from arkaq_edu.pomdp import (
    PolicyTree,
    all_trees,
    bowl,
    problem,
    prune,
    regions,
    solve_pomdp,
    solved,
    tree_value,
    upper_surface,
)
from arkaq_edu.pomdp.backup import candidates
from arkaq_edu.pomdp.surface import CENTERED

BELIEFS = np.linspace(0, 1, 201)


@pytest.mark.thesis("eq 2.23, errata row 15")
@pytest.mark.parametrize(("name", "horizon"), [("tiger", 1), ("two_state", 1), ("two_state", 2)])
def test_the_upper_surface_is_the_best_of_all_plans_there_are(name, horizon):
    model = problem(name)
    alphas = np.array([tree_value(model, tree) for tree in all_trees(model, horizon)])
    plans, p, values = upper_surface(alphas)
    best = (np.column_stack([BELIEFS, 1 - BELIEFS]) @ alphas.T).max(axis=1)
    assert np.interp(BELIEFS, p, values) == pytest.approx(best)
    middle = (p[:-1] + p[1:]) / 2
    assert ((np.column_stack([middle, 1 - middle]) @ alphas.T).argmax(axis=1) == plans).all()


def test_the_candidates_of_three_steps_are_all_plans_made_of_kept_plans():
    pomdp, V = problem("two_state"), solve_pomdp(problem("two_state"), 3)
    kept = [V.shorter.tree(k) for k in range(len(V.shorter))]
    by_hand = [
        tree_value(pomdp, PolicyTree(a, after))
        for a in range(2)
        for after in itertools.product(kept, repeat=3)
    ]
    assert candidates(pomdp, V, 128) == pytest.approx(np.array(by_hand))
    assert len(prune(by_hand)) == len(V) == 7


def test_two_states_make_a_line_and_three_a_bowl():
    with pytest.raises(ValueError, match="alphas must"):
        bowl(solved("two_state", 1), 0, 30)
    with pytest.raises(ValueError, match="alphas must"):
        upper_surface(solved("three_places", 1).alphas)


@pytest.mark.parametrize("horizon", [1, 2, 4])
def test_the_faces_of_the_bowl_are_where_each_plan_is_best(horizon):
    V = solve_pomdp(problem("three_places"), horizon)
    seen = bowl(V, 0, 90)
    assert sorted(seen.plans) == sorted(regions(V)) == list(range(len(V)))
    for k, shadow in zip(seen.plans, seen.shadows, strict=True):
        # The same region by qhull: the lead over every other plan, inside the triangle.
        ahead = V.alphas[k] - np.delete(V.alphas, k, axis=0)
        to_plane = np.column_stack([CENTERED, np.ones(3)])
        planes = -np.vstack([ahead, np.eye(3)]) @ np.linalg.inv(to_plane).T
        inside = shadow.mean(axis=0)
        corners = HalfspaceIntersection(planes, inside).intersections
        for point in shadow:
            assert np.linalg.norm(corners - point, axis=1).min() < 1e-6
        beliefs = np.column_stack([shadow, np.ones(len(shadow))]) @ np.linalg.inv(to_plane)
        assert V.value(np.clip(beliefs, 0, 1) / np.clip(beliefs, 0, 1).sum(1, keepdims=True)) == (
            pytest.approx(beliefs @ V.alphas[k])
        )
    area = sum(map(_area, seen.shadows))
    assert area == pytest.approx(_area(CENTERED))


def _area(polygon):
    x, y = np.transpose(polygon)
    return abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2


@pytest.mark.parametrize("azimuth", [-170, -14, 0, 75, 120])
@pytest.mark.parametrize("elevation", [5, 32, 80])
def test_what_is_far_is_drawn_before_what_is_near(azimuth, elevation):
    V = solved("three_places", 4)
    seen = bowl(V, azimuth, elevation)
    # Seen from above, up is away from the eye: so the height there is the depth here.
    above = bowl(V, azimuth, 90)
    assert (seen.plans == above.plans).all()
    depth = [
        np.linalg.lstsq(np.column_stack([face, np.ones(len(face))]), flat[:, 1], rcond=None)[0]
        for face, flat in zip(seen.faces, above.faces, strict=True)
    ]
    hidden = 0
    for point in np.random.default_rng(0).uniform([-0.9, -0.9], [0.9, 1.2], (400, 2)):
        depths = [
            depth[i] @ [*point, 1] for i, face in enumerate(seen.faces) if _covers(face, point)
        ]
        assert depths == sorted(depths, reverse=True)
        hidden += len(depths) > 1
    assert hidden > 3 or elevation > 5


def _covers(polygon, point):
    edges = np.roll(polygon, -1, axis=0) - polygon
    gaps = point - polygon
    turns = edges[:, 0] * gaps[:, 1] - edges[:, 1] * gaps[:, 0]
    return (turns > 0).all() or (turns < 0).all()


def test_the_scale_measures_the_height_of_the_bowl():
    V = solved("three_places", 2)
    seen = bowl(V, 46.0, 38.0)
    values, places = seen.scale
    assert values.tolist() == [2, 3, 4, 5]
    (x, top), *_ = sorted(seen.corners[:, 1].tolist())  # the leftmost corner of the bowl
    assert places[:, 0] == pytest.approx([x] * 4)
    assert places[-1, 1] == pytest.approx(top), "the corners are worth 5"
    assert np.ptp(np.diff(places[:, 1])) == pytest.approx(0)
    assert len(bowl(V, 46.0, 80.0).scale[0]) == 0, "from high up there is no height to read"
