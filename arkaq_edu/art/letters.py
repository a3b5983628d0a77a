"""Eight letters of five by five points, the patterns that chapter 6 shows to ART1."""

import numpy as np

from arkaq_edu.art.art1 import ART1

#: The letters by name, row by row from the top.
LETTERS = {
    name: np.array([int(point) for point in rows.replace(" ", "")])
    for name, rows in {
        "L": "10000 10000 10000 10000 11111",
        "T": "11111 00100 00100 00100 00100",
        "F": "11111 10000 11110 10000 10000",
        "E": "11111 10000 11110 10000 11111",
        "I": "00100 00100 00100 00100 00100",
        "H": "10001 10001 11111 10001 10001",
        "P": "11110 10001 11110 10000 10000",
        "U": "10001 10001 10001 10001 01110",
    }.items()
}


def learn_letters(vigilance: float) -> ART1:
    """Return ART1 after it has seen the letters again and again, until no template changes.

    Examples
    --------
    >>> learn_letters(1.0).n_clusters_
    8
    """
    patterns = list(LETTERS.values())
    network = ART1(vigilance).fit(patterns)
    while True:
        before = network.cluster_centers_
        if np.array_equal(before, network.partial_fit(patterns).cluster_centers_):
            return network
