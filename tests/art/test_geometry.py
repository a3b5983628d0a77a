"""The map of centers: its cells, and their colors."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.path import Path as Polygon

from arkaq_edu.art.geometry import six_colors, voronoi_cells


def scattered(n, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (n, 2))


@pytest.mark.parametrize("n", [1, 2, 3, 30, 400])
def test_a_cell_holds_the_points_nearest_to_its_center(n):
    centers = scattered(n)
    polygons, _ = voronoi_cells(centers)
    points = scattered(500, seed=1)
    gaps = np.linalg.norm(points[:, None] - centers, axis=2)
    inside = np.array([Polygon(polygon).contains_points(points) for polygon in polygons])
    assert inside.sum(axis=0).tolist() == [1] * len(points)
    assert inside.argmax(axis=0).tolist() == gaps.argmin(axis=1).tolist()


def test_cells_that_touch_are_paired():
    centers = np.array([[x, y] for y in (-0.5, 0.5) for x in (-0.6, 0.0, 0.61)])
    centers[3:, 0] += 0.1  # bricks: no four cells meet in a point
    _, pairs = voronoi_cells(centers)
    rows = {(0, 1), (1, 2), (3, 4), (4, 5)}
    between = {(0, 3), (1, 3), (1, 4), (2, 4), (2, 5)}
    assert set(map(tuple, pairs.tolist())) == rows | between


@given(st.integers(1, 300), st.integers(0, 10**6))
def test_no_neighbors_share_a_color(n, seed):
    _, pairs = voronoi_cells(scattered(n, seed))
    colors = np.array(six_colors(n, pairs))
    assert len(colors) == n and colors.min() >= 0 and colors.max() <= 5
    assert (colors[pairs[:, 0]] != colors[pairs[:, 1]]).all()


def test_six_that_all_touch_take_six_colors_and_seven_are_no_map():
    for n in (5, 6):
        assert len(set(six_colors(n, list(itertools.combinations(range(n), 2))))) == n
    with pytest.raises(ValueError, match="pairs must be those of a map in the plane"):
        six_colors(7, list(itertools.combinations(range(7), 2)))


def test_centers_as_far_as_allowed_still_have_cells_of_their_own():
    centers = [[4.0, 0.0], [-4.0, 0.0], [0.0, -4.0]]
    polygons, pairs = voronoi_cells(centers)
    for center, polygon in zip(centers, polygons, strict=True):
        assert Polygon(polygon).contains_point(center)
    assert sorted(pairs.tolist()) == [[0, 1], [0, 2], [1, 2]]
    with pytest.raises(ValueError, match="centers must be distinct points within 4 of 0"):
        voronoi_cells([[4.01, 0.0]])
