"""Cassandra's .POMDP format, and the course's own problem files."""

import itertools
import pickle
import random
import re
import tracemalloc
from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from arkaq_edu._paths import course_folder
from arkaq_edu.pomdp import POMDP, PomdpFormatError, belief_update, problem, read_pomdp, write_pomdp

OWN = sorted((course_folder() / "data" / "pomdp").glob("*.pomdp"))

PREAMBLE = """\
discount: 0.5
values: reward
states: a b
actions: go stay
observations: x y z
"""
MODEL = PREAMBLE + "T: * identity\nO: * uniform\n"


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "a.pomdp"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_pomdp(path)

    return read


# What is read


def test_a_file_in_every_word(read):
    pomdp = read(
        """# A comment, with a word of the format: states: 3
        values:cost discount :.5   # both on one line, in any order, with blanks or none
        observations: x y
        states: a b
        actions: go stay
        start: 0.25 0.75
        T: go
          0 1
          1. 0.0e0
        T:stay identity
        O : * uniform
        O: stay : b : * 0
        O: 1 : 1 : y 1
        R: go : * : * : * 1
        R: stay : a : * : x - 3
        """
    )
    assert (pomdp.states, pomdp.actions) == (("a", "b"), ("go", "stay"))
    assert (pomdp.observations, pomdp.gamma) == (("x", "y"), 0.5)
    np.testing.assert_array_equal(pomdp.start, [0.25, 0.75])
    np.testing.assert_array_equal(pomdp.T, [[[0, 1], [1, 0]], [[1, 0], [0, 1]]])
    np.testing.assert_array_equal(pomdp.O, [[[0.5, 0.5]] * 2, [[0.5, 0.5], [0, 1]]])
    np.testing.assert_array_equal(pomdp.R, [[-1, 1.5], [-1, 0]])


@pytest.mark.parametrize(
    ("start", "belief"),
    [
        ("", [0.25, 0.25, 0.25, 0.25]),
        ("start: uniform", [0.25, 0.25, 0.25, 0.25]),
        ("start: 0.1 0.2 0.3 0.4", [0.1, 0.2, 0.3, 0.4]),
        ("start: 1 0 0 0", [1, 0, 0, 0]),
        ("start: c", [0, 0, 1, 0]),
        ("start: 3", [0, 0, 0, 1]),
        ("start include: a 2", [0.5, 0, 0.5, 0]),
        ("start include : *", [0.25, 0.25, 0.25, 0.25]),
        ("start exclude: b c d", [1, 0, 0, 0]),
    ],
)
def test_every_start(read, start, belief):
    text = MODEL.replace("a b", "a b c d").replace("T:", f"{start}\nT: * : * reset\nT:", 1)
    pomdp = read(text.replace("T: * identity\n", ""))
    np.testing.assert_array_equal(pomdp.start, belief)
    np.testing.assert_array_equal(pomdp.T, np.broadcast_to(belief, (2, 4, 4)))  # by reset


def test_one_state_starts_there(read):
    for start in ("start: 1", "start: 1.0", "start: uniform", "start: a"):
        text = MODEL.replace("a b", "a").replace("T:", f"{start}\nT:", 1)
        np.testing.assert_array_equal(read(text).start, [1])


def test_an_mdp_becomes_a_pomdp_that_sees_its_state(read):
    pomdp = read(
        """discount: 0.9  values: reward  states: near far  actions: walk
        T: walk  0.5 0.5  0 1
        R: walk  1 2  3 4
        R: walk : far : far 8"""
    )
    assert pomdp.observations == pomdp.states
    np.testing.assert_array_equal(pomdp.O, [np.eye(2)])
    np.testing.assert_array_equal(pomdp.R, [[1.5], [8]])


def test_a_printed_third_is_a_third(read):
    for digits in ("0.3333", "0.333333", ".33333333"):
        row = f"{digits} {digits} {digits}"
        pomdp = read(MODEL.replace("O: * uniform", f"O: * : *\n{row}"))
        np.testing.assert_allclose(pomdp.O, np.full((2, 2, 3), 1 / 3), rtol=1e-14)


def test_ends_of_lines_and_bytes_that_are_no_text(read):
    expected = read(MODEL)
    for end in ("\r\n", "\r"):
        assert repr(read(MODEL.replace("\n", end))) == repr(expected)
    for first in (b"# Cassandra \xe9\xff\n", b"\xef\xbb\xbf"):
        assert repr(read(first + MODEL.encode())) == repr(expected)


# Random files of all forms, read in a second way: entry by entry, with every sum written out

A, S, Z = ("go", "stay"), ("a", "b", "c"), ("x", "y")
AXES = {"T": (A, S, S), "O": (A, S, Z), "R": (A, S, S, Z)}


def places(axis):
    """One place on an axis, or all: how it is written, and which numbers it stands for."""
    one = st.integers(0, len(axis) - 1)
    written = one.flatmap(lambda i: st.sampled_from([(axis[i], [i]), (str(i), [i])]))
    return st.one_of(st.just(("*", list(range(len(axis))))), written)


@st.composite
def entries(draw):
    letter = draw(st.sampled_from("TOR"))
    axes = AXES[letter]
    # Rows and matrices alone keep probabilities that sum to 1.
    n = draw(st.integers(2, 4) if letter == "R" else st.integers(1, 2))
    key = [draw(places(axis)) for axis in axes[:n]]
    shape = [len(axis) for axis in axes[n:]]
    words = {"T1": ["uniform", "identity"], "T2": ["uniform", "reset"]}
    words |= {"O1": ["uniform"], "O2": ["uniform"]}
    word = draw(st.sampled_from([None, *words.get(f"{letter}{n}", [])]))
    if letter == "R":
        size = int(np.prod(shape))
        values = draw(st.lists(st.integers(-9, 9), min_size=size, max_size=size))
        block = np.reshape(values, shape).astype(float)
    elif word == "identity":
        block = np.eye(3)
    elif word == "reset":
        block = np.array([0.5, 0.25, 0.25])
    elif word == "uniform":
        block = np.full(shape, 1 / shape[-1])
    else:
        row = [[0.5, 0.5, 0], [1, 0, 0], [0.25, 0.25, 0.5]]
        row = row if shape[-1] == 3 else [[0.75, 0.25], [0, 1]]
        rows = [draw(st.sampled_from(row)) for _ in range(int(np.prod(shape[:-1])))]
        block = np.reshape(rows, shape)
    colon = draw(st.sampled_from([":", " : ", " :", ":\n"]))
    numbers = word or " ".join(map(str, np.ravel(block)))
    text = f"{letter}{colon}{colon.join(name for name, _ in key)}\n{numbers}"
    return text + draw(st.sampled_from(["\n", "  # T: 0\n"])), letter, key, block


@settings(max_examples=150, deadline=None)
@given(written=st.lists(entries(), max_size=8))
def test_every_form_of_entry(tmp_path_factory, written):
    text = (
        f"discount: 0.9\nvalues: reward\nstates: {' '.join(S)}\nactions: {' '.join(A)}\n"
        f"observations: {' '.join(Z)}\nstart: 0.5 0.25 0.25\nT: * uniform\nO: * uniform\n"
    )
    path = tmp_path_factory.mktemp("entries") / "a.pomdp"
    path.write_text(text + "".join(entry[0] for entry in written))
    table = {letter: np.zeros([len(axis) for axis in axes]) for letter, axes in AXES.items()}
    table["T"][:], table["O"][:] = 1 / 3, 1 / 2
    for _, letter, key, block in written:
        for place in itertools.product(*(numbers for _, numbers in key)):
            table[letter][place] = block
    T, O, R = table["T"], table["O"], table["R"]  # noqa: E741
    pomdp = read_pomdp(path)
    np.testing.assert_array_equal(pomdp.T, T)
    np.testing.assert_array_equal(pomdp.O, O)
    expected = [
        [sum(T[a, s, t] * O[a, t, z] * R[a, s, t, z] for t in range(3) for z in range(2))
         for a in range(2)]
        for s in range(3)
    ]  # fmt: skip
    np.testing.assert_allclose(pomdp.R, expected, rtol=0, atol=1e-12)


# What is refused, and where


@pytest.mark.parametrize(
    ("text", "line", "column", "said"),
    [
        ("", 1, 1, "expected 'discount:' and 'values:' and 'states:' and 'actions:', got the end"),
        (MODEL.replace("reward", "money"), 2, 9, "'reward' or 'cost', got 'money'"),
        (MODEL.replace("values: reward\n", ""), 5, 1, "'values:', got 'T'"),
        (MODEL.replace("values", "discount: 0.2\nvalues"), 2, 1, "'discount:' only once"),
        (MODEL.replace("0.5", "-0.5"), 1, 11, "a discount in [0, 1], got -0.5"),
        (MODEL.replace("0.5", "1.5"), 1, 11, "a discount in [0, 1], got 1.5"),
        (MODEL.replace("0.5", "nan"), 1, 11, "a discount in [0, 1], got 'nan'"),
        (MODEL.replace("0.5", "0.5.5"), 1, 11, "got '0.5.5'"),
        (MODEL.replace("a b", "a b a"), 3, 13, "different names for the states, got 'a'"),
        (MODEL.replace("a b", "0"), 3, 9, "a count of states from 1 to 65536, got '0'"),
        (MODEL.replace("a b", "uniform"), 3, 9, "or their names, none of them a word of the"),
        (MODEL.replace("a b", "9" * 5000), 3, 9, "a count of states from 1 to 65536, got '99"),
        (MODEL.replace("observations: x y z\n", ""), 6, 1, "without 'observations:', got 'O'"),
        (PREAMBLE + "start: 0.5 0.6\n" + "T: * identity", 6, 8, "those of 'start' sum to 1.1"),
        (PREAMBLE + "start: 0.5\n" + "T: * identity", 7, 1, "(1 of 2 are given), got 'T'"),
        (PREAMBLE + "start: 2", 6, 8, "a state from 0 to 1, got 2"),
        (PREAMBLE + "start exclude: *", 6, 1, "at least one state that is not excluded"),
        (PREAMBLE + "start include: go", 6, 16, "one of the states (a, b) or '*', got 'go'"),
        (PREAMBLE + "O: * uniform", 6, 13, "the probabilities of 'T: go : a'; they are not given"),
        (PREAMBLE + "T: * uniform", 6, 13, "the probabilities of 'O: go : a'; they are not given"),
        (MODEL + "T: go : a : b 0.5", 8, 1, "those of 'T: go : a' sum to 1.5"),
        (MODEL + "O: 1 : *\n0.5 0.3 0.1", 8, 1, "those of 'O: stay : a' sum to 0.9"),
        (MODEL + "O: 1 : *\n0.5 0.3 0.1998", 8, 1, "those of 'O: stay : a' sum to 0.9998"),
        (MODEL + "T: go : a\n1.5 -0.5", 9, 1, "a probability in [0, 1], got 1.5"),
        (MODEL + "T: go : a\n0.5 -0.5", 9, 5, "a probability in [0, 1], got -0.5"),
        (MODEL + "T: go : a\n0.5 nan", 9, 5, "probability in [0, 1] (1 of 2 are given), got 'nan'"),
        (MODEL + "T: go 1 0 0 1 0", 8, 15, "'T', 'O' or 'R' (the entry before is complete)"),
        (MODEL + "T: go\n1 0\n0 ", 10, 3, "(3 of 4 are given), got the end of the file"),
        (MODEL + "T go", 8, 3, "':', got 'go'"),
        (MODEL + "T: run uniform", 8, 4, "one of the actions (go, stay) or '*', got 'run'"),
        (MODEL + "T: 2 uniform", 8, 4, "one of the actions (go, stay) or '*', got '2'"),
        (MODEL + "O: go identity", 8, 7, "a probability in [0, 1] (0 of 6 are given)"),
        (MODEL + "T: go : a identity", 8, 11, "a probability in [0, 1] (0 of 2 are given)"),
        (MODEL + "T: go reset", 8, 7, "a probability in [0, 1] (0 of 4 are given)"),
        (MODEL + "R: go 1", 8, 7, "':', got '1'"),
        (MODEL + "R: go : a : b : w 1", 8, 17, "one of the observations (x, y, z) or '*', got 'w'"),
        (MODEL + "R: go : a : b : x 1e999", 8, 19, "a reward in [-1e+100, 1e+100], got 1e999"),
        (MODEL + "R: go : a : b : x - -1", 8, 21, "a reward in [-1e+100, 1e+100], got '-1'"),
        (MODEL + "R: go : a : b : x inf", 8, 19, "1e+100], got 'inf'"),
        (MODEL + "states: 2", 8, 1, "'T' or 'O' or 'R', got 'states'"),
        (MODEL + "\n\n  \x00", 10, 3, r"'T' or 'O' or 'R', got '\x00'"),
    ],
)  # fmt: skip
def test_what_is_refused_and_where(read, tmp_path, text, line, column, said):
    with pytest.raises(PomdpFormatError, match=re.escape(said)) as refusal:
        read(text)
    error = refusal.value
    assert (error.line, error.column) == (line, column)
    assert error.path == str(tmp_path / "a.pomdp")
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))  # as a pool of processes hands it on
    assert (str(again), again.line) == (str(error), line)


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "said"),
    [
        ("a b", "L R", 3, 11, "(write another name, such as 'R_'), got 'R'"),
        ("a b", "T O", 3, 9, "(write another name, such as 'T_'), got 'T'"),
        ("go stay", "go reset", 4, 13, "a count of actions or their names, none of them a word"),
        ("a b", "room.1 room.2", 3, 9, "'_' and '-' (such as 'room_1'), got 'room.1'"),
        ("a b", "a 2b", 3, 11, "made of a letter, then letters, digits"),
        ("a b", "a 7", 3, 11, "(such as 's7'), got '7'"),
        ("a b", "2 5", 3, 11, "a count of states or their names, not both, got '5'"),
        ("a b", "2 a", 3, 11, "a count of states or their names, not both, got 'a'"),
        ("values: reward", "costs: 1", 2, 1, "R); write 'values: cost' instead, got 'costs'"),
        ("values: reward", "rewards: 1", 2, 1, "write 'values: reward' before the names"),
        ("values: reward", "value: reward", 2, 1, "write 'values:' instead, got 'value'"),
        ("values: reward", "values: rewards", 2, 9, "(write 'reward' for 'rewards')"),
        ("values: reward", "values: costs", 2, 9, "(write 'cost' for 'costs'), got 'costs'"),
        ("discount", "gamma", 1, 1, "write 'discount:' instead, got 'gamma'"),
        ("go stay", "go stay\nhorizon: 3", 5, 1, "observations, start, T, O, R), got 'horizon'"),
        ("T: * identity", "T: * identity\nE: * uniform", 7, 1, "write 'O:' for observations"),
        ("T: *", "start: a b\nT: *", 6, 10, "write 'start include: a b'), got 'b'"),
        ("T: *", "start: a 0.5\nT: *", 6, 10, "one state or a probability for each state"),
        ("T: *", "initial: a\nT: *", 6, 1, "write 'start:' instead, got 'initial'"),
        ("0.5", "0,5", 1, 11, "a discount in [0, 1], got '0,5'"),
    ],
)  # fmt: skip
def test_what_other_dialects_write_is_told_from_what_this_one_does(
    read, old, new, line, column, said
):
    with pytest.raises(PomdpFormatError, match=re.escape(said)) as refusal:
        read(MODEL.replace(old, new, 1))
    assert (refusal.value.line, refusal.value.column) == (line, column)


def test_a_word_of_the_format_with_a_colon_ends_the_names(read):
    text = MODEL.replace("observations: x y z\n", "observations: x y z start\n  include : a\n")
    np.testing.assert_array_equal(read(text).start, [1, 0])
    assert read(MODEL.replace("x y z\n", "x y z # T\n")).observations == ("x", "y", "z")


def test_without_a_discount_the_values_have_a_horizon(read):
    assert read(MODEL.replace("0.5", "1.0")).gamma == 1


def test_a_probability_that_rounding_left_above_one(read):
    pomdp = read(MODEL + "T: go : a\n1.0000000000000002 0\nO: go : a\n0 1.00000001 0\n")
    np.testing.assert_array_equal(pomdp.T[0, 0], [1, 0])
    np.testing.assert_array_equal(pomdp.O[0, 0], [0, 1, 0])


@pytest.mark.parametrize(
    "line",
    ["T: * identity", "T: * : * : * 0", "T: * : *\nreset", "O: * uniform", "O: * : * : x 1",
     "R: * : * : 7 : * 2"],
)  # fmt: skip
def test_what_a_line_costs_counts_and_not_its_length(read, line):
    text = "discount: 0.5\nvalues: reward\nstates: 4000\nactions: 2\nobservations: x y\n"
    text += "T: * identity\nO: * uniform\n" + f"{line}\n" * 3000
    said = rf"line \d+, .* entries of {line[0]} that set at most 16777216 numbers in all; with"
    with pytest.raises(PomdpFormatError, match=said):
        read(text)


def test_a_large_file_is_read_without_a_dense_table(read, tmp_path):
    n = 3000  # a ring: go leads one state on, with a slip; only the first state looks different
    text = f"discount: 0.95\nvalues: reward\nstates: {n}\nactions: go stay\n"
    text += "observations: x y\nstart: 0\nO: * : * : x 1\nO: * : 0\n0.3 0.7\nT: stay identity\n"
    text += "".join(f"T: go : {s} : {s} 0.25\nT: go : {s} : {(s + 1) % n} 0.75\n" for s in range(n))
    text += "R: go : * : 7 : * 8\nR: go : 0 : 0 : y 20\nR: * : 5 : * : * -1\n"
    tracemalloc.start()
    pomdp = read(text)
    assert tracemalloc.get_traced_memory()[1] < 30e6  # a dense T takes 144 MB
    tracemalloc.stop()
    go, stay = pomdp.T
    assert (go.nnz, stay.nnz) == (2 * n, n)
    assert (go[5, 6], go[5, 5], go[5, 7]) == (0.75, 0.25, 0)
    np.testing.assert_array_equal(pomdp.O[0][:2], [[0.3, 0.7], [1, 0]])
    expected = np.zeros((n, 2))
    expected[[6, 7, 0], 0] = 6, 2, 0.25 * 0.7 * 20
    expected[5] = -1
    np.testing.assert_allclose(pomdp.R, expected, atol=1e-15)
    write_pomdp(pomdp, tmp_path / "again.pomdp")
    again = read_pomdp(tmp_path / "again.pomdp")
    np.testing.assert_array_equal(again.R, pomdp.R)
    for one, other in zip(again.T, pomdp.T, strict=True):
        assert (one != other).nnz == 0
    b = belief_update(again, again.start, 0, 1)
    assert np.flatnonzero(b).tolist() == [0]


def test_an_mdp_of_many_states_is_seen_through_sparse_eyes(read):
    n = 2000
    pomdp = read(f"discount: 0.9 values: reward states: {n} actions: 1 T: 0 identity")
    assert (pomdp.O[0] != pomdp.T[0]).nnz == 0
    assert pomdp.n_observations == n


def test_rewards_of_steps_and_observations_that_cannot_happen_do_not_count(read):
    pomdp = read(
        MODEL + "O: go : a : x 1\nO: go : a : y 0\nO: go : a : z 0\n"
        "R: go : a : a : y 5\nR: go : a : b : x 7\nR: go : b : b 3 6 9\n"
        "R: stay : a\n1 2 3\n4 5 6\n"
    )
    np.testing.assert_allclose(pomdp.R, [[0, 2], [6, 0]], rtol=1e-15)


def test_rewards_that_could_overflow_are_refused_where_they_stand(read):
    text = MODEL + "R: * : a : * : x 1e100\n"
    assert read(text).R[0] == pytest.approx(1e100 / 3)
    with pytest.raises(PomdpFormatError, match=r"expected a reward in .*, got 1\.1e100") as refusal:
        read(text + "R: * : b : * : x 1.1e100\n")
    assert (refusal.value.line, refusal.value.column) == (9, 18)


@pytest.mark.parametrize("counts", [(65536, 65536, 65536), (4097, 1, 1), (1, 65536, 257)])
def test_what_does_not_fit_is_refused_before_it_takes_memory(read, counts):
    n_states, n_actions, n_observations = counts
    text = f"discount: 0\nvalues: cost\nstates: {n_states}\nactions: {n_actions}\n"
    tracemalloc.start()
    with pytest.raises(PomdpFormatError, match=r"at most 16777216 (rows|numbers)"):
        read(text + f"observations: {n_observations}\nT: * uniform\nO: * uniform\n")
    assert tracemalloc.get_traced_memory()[1] < 60e6
    tracemalloc.stop()


def test_a_file_that_is_too_large_is_refused(tmp_path):
    path = tmp_path / "large.pomdp"
    with open(path, "wb") as file:
        file.truncate(2**27 + 1)  # takes no room on the disk
    with pytest.raises(PomdpFormatError, match="at most 134217728 bytes"):
        read_pomdp(path)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_pomdp(tmp_path / "none.pomdp")


# Fuzz: a million bytes of files that are almost right


def mutant(rng, texts):
    """A file of the course, damaged in a few places."""
    text = rng.choice(texts)
    nasty = [
        *"TOR:*#-+01.e\n", "nan", "-inf", "1e999", "1e-999", "-0", "0x1", "2", "65537", "1900",
        "99999999999999999999", "uniform", "identity", "reset", "start", "include", "exclude",
        "states:", "observations:", "discount: 1", "values: cost", "é", "\0", "\ufeff", "\r",
    ]  # fmt: skip
    for _ in range(rng.randint(1, 3)):
        tokens = re.findall(r"\s+|[\w.-]+|.", text) or [" "]
        i, j = sorted(rng.choices(range(len(tokens)), k=2))
        match rng.randrange(9):
            case 0:  # bytes
                data = bytearray(text.encode("latin-1", errors="replace"))
                for _ in range(rng.randint(1, 4)):
                    data[rng.randrange(len(data))] = rng.randrange(256)
                text = data.decode("latin-1")
            case 1:  # the end is missing
                text = text[: rng.randrange(len(text))] or " "
            case 2:  # two files in one
                other = rng.choice(texts)
                text = text[: rng.randrange(len(text))] + other[rng.randrange(len(other)) :]
            case 3:
                tokens[i], tokens[j] = tokens[j], tokens[i]
                text = "".join(tokens)
            case 4:
                text = "".join(tokens[:i] + tokens[min(j, i + 5) :]) or " "
            case 5:
                text = "".join(tokens[:j] + tokens[i : i + 20] + tokens[j:])
            case 6:
                text = "".join(tokens[:i]) + rng.choice(nasty) + "".join(tokens[i:])
            case _:
                tokens[i] = rng.choice(nasty)
                text = "".join(tokens)
    return text.encode("latin-1", errors="replace")


def test_a_million_bytes_of_damaged_files_end_in_a_model_or_in_our_error(tmp_path):
    rng = random.Random(0)
    bare = [re.sub(r"#.*", "", path.read_text()) for path in OWN]  # a blow to a comment is none
    texts = [re.sub(r"\n\s+", "\n", text) for text in bare] + [path.read_text() for path in OWN]
    path = tmp_path / "mutant.pomdp"
    n_bytes = n_models = n_errors = 0
    while n_bytes < 1_000_000:
        data = mutant(rng, texts)
        n_bytes += len(data)
        path.write_bytes(data)
        try:
            pomdp = read_pomdp(path)
        except PomdpFormatError as error:
            n_errors += 1
            assert 1 <= error.line <= data.count(b"\n") + data.count(b"\r") + 1
            assert 1 <= error.column <= len(data) + 1
            assert len(str(error)) < 500 + len(error.path)
        else:
            n_models += 1
            for rows in (pomdp.T, pomdp.O, pomdp.start):
                assert (rows >= 0).all()
                np.testing.assert_allclose(rows.sum(axis=-1), 1, rtol=0, atol=1e-9)
            assert 0 <= pomdp.gamma <= 1
    assert min(n_models, n_errors) > 100  # both ends are reached


# What is written


def distributions(n):
    parts = st.lists(st.floats(0, 1), min_size=n, max_size=n)
    return parts.map(lambda x: np.array(x) / sum(x) if sum(x) > 1e-3 else np.eye(n)[0])


@st.composite
def pomdps(draw):
    n_states, n_actions, n_observations = (draw(st.integers(1, 3)) for _ in range(3))

    def rows(n, *shape):
        return [rows(n, *shape[1:]) for _ in range(shape[0])] if shape else draw(distributions(n))

    def names(n):
        word = st.text("aZ0_-", max_size=5).map("n".__add__)
        return draw(st.none() | st.lists(word, min_size=n, max_size=n, unique=True))

    reward = st.floats(-1e90, 1e90)
    R = [[draw(reward) for _ in range(n_actions)] for _ in range(n_states)]
    return POMDP(
        rows(n_states, n_actions, n_states),
        rows(n_observations, n_actions, n_states),
        R,
        draw(st.floats(0, 1, exclude_max=True)),
        draw(st.none() | distributions(n_states)),
        states=names(n_states),
        actions=names(n_actions),
        observations=names(n_observations),
    )


def assert_same(one, other):
    for table in ("T", "O", "R", "start"):
        assert getattr(one, table).tobytes() == getattr(other, table).tobytes(), table
    for said in ("gamma", "states", "actions", "observations"):
        assert getattr(one, said) == getattr(other, said), said


@settings(max_examples=60, deadline=None)
@given(pomdp=pomdps())
def test_what_is_written_is_read_to_the_last_bit(tmp_path_factory, pomdp):
    path = tmp_path_factory.mktemp("written") / "a.pomdp"
    write_pomdp(pomdp, path)
    first = path.read_bytes()
    again = read_pomdp(path)
    assert_same(again, pomdp)
    write_pomdp(again, path)
    assert path.read_bytes() == first


def test_what_rounding_left_above_one_is_written_and_read(tmp_path):
    T = np.eye(2)[np.newaxis] * 1.0000000000000002
    pomdp = POMDP(T, [[[0.9999999999999999], [1]]], [[1], [0]], 1.0)
    assert pomdp.mdp.ends.tolist() == [False, True]
    write_pomdp(pomdp, tmp_path / "a.pomdp")
    assert_same(read_pomdp(tmp_path / "a.pomdp"), pomdp)


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_the_courses_files_are_written_and_read(path, tmp_path):
    pomdp = read_pomdp(path)
    write_pomdp(pomdp, tmp_path / "again.pomdp")
    assert_same(read_pomdp(tmp_path / "again.pomdp"), pomdp)


@pytest.mark.parametrize("name", ["two words", "9", "T", "reset", "é", "-a"])
def test_a_name_that_the_format_cannot_hold_is_refused(tmp_path, name):
    pomdp = POMDP([np.eye(2)], [[[1], [1]]], [[0], [0]], 0.9, states=["left", name])
    path = tmp_path / "a.pomdp"
    path.write_text("precious")
    with pytest.raises(ValueError, match=f"states must be words .* got '{name}'"):
        write_pomdp(pomdp, path)
    assert path.read_text() == "precious"


def test_it_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "a.pomdp"
    path.write_text("precious")
    whole = Path.write_text

    def disk_full(target, text, **how):
        whole(target, text[: len(text) // 2], **how)
        raise OSError("no space left")

    monkeypatch.setattr(Path, "write_text", disk_full)
    with pytest.raises(OSError, match="no space"):
        write_pomdp(problem("tiger"), path)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.pomdp", "precious")]


# The course's own problems


def test_every_problem_is_explained_and_named_in_words():
    assert len(OWN) == 7
    for path in OWN:
        assert path.read_text().startswith("# ")
        pomdp = problem(path.stem)
        words = (*pomdp.states, *pomdp.actions, *pomdp.observations)
        assert all(word[0].isalpha() for word in words)


def test_a_problem_that_is_none_is_refused():
    allowed = "ball_side, cheese, corridor, floors, three_places, tiger, two_state"
    for name in ("chess", "../pomdp/tiger", ""):
        with pytest.raises(ValueError, match=f"one of {allowed}, got {name!r}"):
            problem(name)


def test_the_tiger_has_the_numbers_of_the_literature():
    tiger = problem("tiger")
    listen = tiger.actions.index("listen")
    np.testing.assert_array_equal(tiger.O[listen], [[0.85, 0.15], [0.15, 0.85]])
    np.testing.assert_array_equal(tiger.T[listen], np.eye(2))
    np.testing.assert_array_equal(tiger.R, [[-1, -100, 10], [-1, 10, -100]])
    assert tiger.gamma == 0.95


def test_the_two_state_problem_has_the_rewards_of_the_thesis():
    pomdp = problem("two_state")
    assert pomdp.T.shape == (2, 2, 2)
    assert pomdp.n_observations == 3
    np.testing.assert_allclose(np.array([0.25, 0.75]) @ pomdp.R, [0.25, 1.125])


def vectors(pomdp, horizon):
    """Every tree of every branch that is best somewhere, on a fine grid of beliefs of 2 states."""
    x = np.linspace(0, 1, 2001)
    beliefs = np.stack([x, 1 - x])
    kept = trees = pomdp.R.T
    for _ in range(horizon - 1):
        trees = np.array(
            [
                pomdp.R[:, a]
                + pomdp.gamma * sum(pomdp.T[a] @ (pomdp.O[a, :, z] * v) for z, v in enumerate(vs))
                for a in range(pomdp.n_actions)
                for vs in itertools.product(kept, repeat=pomdp.n_observations)
            ]
        )
        kept = trees[np.unique((trees @ beliefs).argmax(axis=0))]
    return kept, trees


def test_the_two_state_problem_is_as_its_file_says():
    pomdp = problem("two_state")
    assert [len(vectors(pomdp, h)[0]) for h in (1, 2, 3)] == [2, 4, 7]
    kept, trees = vectors(pomdp, 2)
    assert len(trees) == 16
    below_one = [
        any((tree <= other).all() for j, other in enumerate(trees) if j != i)
        for i, tree in enumerate(trees)
    ]
    assert (sum(below_one), len(trees) - len(kept) - sum(below_one)) == (8, 4)
