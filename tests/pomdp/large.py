"""Two large problems of the literature, built from their rules: Tag and RockSample."""

import numpy as np
from scipy import sparse

from arkaq_edu.pomdp import POMDP

NORTH, EAST, SOUTH, WEST = (0, 1), (1, 0), (0, -1), (-1, 0)


def tag():
    """A robot hunts an opponent that runs away; it sees it only in its own cell (870 states).

    J. Pineau, G. Gordon, S. Thrun, "Point-based value iteration", IJCAI 2003.
    """
    cells = [(x, y) for y in range(2) for x in range(10)]
    cells += [(x, y) for y in range(2, 5) for x in (5, 6, 7)]
    number = {cell: i for i, cell in enumerate(cells)}
    n, tagged = len(cells), len(cells)
    S = n * (n + 1)  # the robot's cell, and the opponent's, or that it was tagged

    def beside(cell, way):
        return number.get((cell[0] + way[0], cell[1] + way[1]))

    def flight(robot, other):
        """Where the opponent goes: away along an axis, each .4, or it stays."""
        (x, y), (u, v) = cells[robot], cells[other]
        ways = {way: 0.0 for way in (NORTH, EAST, SOUTH, WEST)}
        for away, one, two in ((u - x, EAST, WEST), (v - y, NORTH, SOUTH)):
            for way in (one,) if away > 0 else (two,) if away < 0 else (one, two):
                ways[way] += 0.4 if away else 0.2
        chances = {other: 0.2}
        for way, p in ways.items():
            to = beside(cells[other], way)
            chances[other if to is None else to] = chances.get(other if to is None else to, 0) + p
        return chances

    T = [sparse.lil_array((S, S)) for _ in range(5)]
    R = np.full((S, 5), -1.0)
    O = np.zeros((5, S, n + 1))  # noqa: E741  (the robot's cell; the last: the opponent is here)
    for robot in range(n):
        for other in range(n + 1):
            s = robot * (n + 1) + other
            O[:, s, n if robot == other else robot] = 1
            if other == tagged:
                for a in range(5):
                    T[a][s, s] = 1
                R[s] = 0
                continue
            for a, way in enumerate((NORTH, EAST, SOUTH, WEST)):
                to = beside(cells[robot], way)
                to = robot if to is None else to
                for place, p in flight(robot, other).items():
                    T[a][s, to * (n + 1) + place] += p
            R[s, 4] = 10 if robot == other else -10
            if robot == other:
                T[4][s, robot * (n + 1) + tagged] = 1
            else:
                for place, p in flight(robot, other).items():
                    T[4][s, robot * (n + 1) + place] += p
    start = np.ones((n, n + 1))
    start[:, tagged] = 0
    return POMDP([M.tocsr() for M in T], O, R, 0.95, start.ravel() / start.sum())


def rock_sample(n, rocks, half=20.0):
    """A rover looks at rocks from afar, samples the good ones, and leaves to the east.

    T. Smith, R. Simmons, "Heuristic search value iteration for POMDPs", UAI 2004. `rocks` are their
    cells; a look errs half the time at an infinite distance, and it errs half as much less often
    for each `half` cells that it is nearer.
    """
    K = len(rocks)
    worlds, end = 2**K, n * n * 2**K
    S, A = end + 1, 5 + K
    T = [sparse.lil_array((S, S)) for _ in range(A)]
    R = np.zeros((S, A))
    O = np.zeros((A, S, 2))  # noqa: E741  (0 for bad or nothing, 1 for good)
    O[:, :, 0] = 1
    for cell in range(n * n):
        x, y = cell % n, cell // n
        for good in range(worlds):
            s = cell * worlds + good
            for a, (dx, dy) in enumerate((NORTH, EAST, SOUTH, WEST)):
                u, v = x + dx, y + dy
                if u == n:
                    T[a][s, end], R[s, a] = 1, 10
                else:
                    u, v = np.clip((u, v), 0, n - 1)
                    T[a][s, (v * n + u) * worlds + good] = 1
            k = rocks.index((x, y)) if (x, y) in rocks else None
            is_good = k is not None and good >> k & 1
            R[s, 4] = 10 if is_good else -10
            T[4][s, s - (1 << k) if is_good else s] = 1
            for k, (u, v) in enumerate(rocks):
                T[5 + k][s, s] = 1
                right = 0.5 + 0.5 * 2 ** (-np.hypot(x - u, y - v) / half)
                O[5 + k, s, 1] = right if good >> k & 1 else 1 - right
                O[5 + k, s, 0] = 1 - O[5 + k, s, 1]
    for a in range(A):
        T[a][end, end] = 1
    start = np.zeros(S)
    first = (n // 2) * n * worlds
    start[first : first + worlds] = 1 / worlds
    return POMDP([M.tocsr() for M in T], O, R, 0.95, start)


def rock_sample_5_4():
    return rock_sample(5, [(1, 0), (3, 1), (2, 3), (4, 4)])
