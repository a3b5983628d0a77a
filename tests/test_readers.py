"""Whatever the bytes of a file are: a thing that is whole, or the reader's own error.

The same targets as under the fuzzer (``make fuzz``); here hypothesis damages good files.
"""

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, given, settings

from tests.fuzz.targets import SEEDS, TARGETS, WORDS


@st.composite
def damaged(draw, name):
    """A good file with pieces cut out, doubled, or put in."""
    data = draw(st.sampled_from(SEEDS[name]()))
    words = [word.encode("latin-1") for word in WORDS[name]]
    for _ in range(draw(st.integers(1, 4))):
        at, length = draw(st.integers(0, len(data))), draw(st.integers(0, 40))
        piece = draw(st.one_of(st.binary(max_size=4), st.sampled_from(words), st.just(data[:at])))
        data = data[:at] + piece + data[at + length :]
    return data


@pytest.mark.parametrize("name", TARGETS)
def test_a_damaged_file_is_read_whole_or_refused(name, tmp_path_factory):
    folder = tmp_path_factory.mktemp(name)

    @settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
    @given(damaged(name))
    def read(data):
        TARGETS[name](data, folder)

    read()
