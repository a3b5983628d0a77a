"""The page of a reproduction."""

import re

import cloudpickle
import matplotlib.pyplot as plt
import pandas as pd

from arkaq_edu.experiments import judge
from arkaq_edu.experiments.claims import VERDICTS, computed
from arkaq_edu.figures.gallery import FIGURES
from arkaq_edu.figures.report import anchor, write_report


def draw(width):
    def figure(ax=None, *, agent=None):
        plt.figure(figsize=(width, 2)).subplots().set_title(f"agent {agent}", loc="left")

    figure.__doc__ = f"Draw figure 5.{width}, the <b> of & all; see `plot`."
    return figure


def page_of(tmp_path, **options):
    exact = pd.DataFrame({"quantity": computed().keys(), "value": computed().values()})
    runs = pd.concat([exact, pd.DataFrame(
        {"quantity": "centers, vigilance 0.1", "seed": range(4), "value": [280, 281, 282, 285]}
    )])  # fmt: skip
    figures = {"5.4": draw(4), "5.11": draw(11)}
    write_report(tmp_path, judge(runs), figures, agent="<x>", **options)
    return (tmp_path / "index.html").read_text(), judge(runs)


def test_every_row_and_figure_can_be_jumped_to_and_is_in_the_contents(tmp_path):
    page, table = page_of(tmp_path)
    ids = re.findall(r' id="([^"]+)"', page)
    assert len(set(ids)) == len(ids)
    assert {anchor(quantity) for quantity in table.quantity} <= set(ids)
    for link in re.findall(r'href="#([^"]+)"', page):
        assert link in ids or link.startswith("figure-"), link
    assert page.count('href="#figure-5.11"') >= 3  # contents, its own, and the row's


def test_the_verdicts_are_counted(tmp_path):
    page, table = page_of(tmp_path)
    for verdict in VERDICTS:
        assert f"<b>{(table.verdict == verdict).sum()}</b> {verdict}" in page


def test_a_figure_says_what_to_see_of_which_seed_and_where_it_differs(tmp_path):
    page, _ = page_of(tmp_path)
    card = page[page.index('<figure id="figure-5.11"') :].split("</figure>")[0]
    text = re.sub(r"<[^>]+>", "", card[card.index("<figcaption>") :])
    assert "The &lt;b&gt; of &amp; all." in text
    assert "One agent, seed 0." in text
    assert "centers, vigilance 0.1: thesis 333, here 282 (280 to 285) outside" in text


def test_all_figures_have_the_same_size_of_text(tmp_path):
    """The width on the page over the width of the picture is the same for narrow and wide."""
    import base64

    page, _ = page_of(tmp_path)
    shown = [int(width) for width in re.findall(r'style="width:(\d+)px', page)]
    pixels = [
        int.from_bytes(base64.b64decode(data)[16:20], "big")
        for data in re.findall(r"base64,([^\"]+)", page)
    ]
    first, second = (a / b for a, b in zip(shown, pixels, strict=True))
    assert pixels[1] > 2 * pixels[0] and abs(first / second - 1) < 0.01


def test_the_page_is_one_file_escaped_and_the_same_every_time(tmp_path):
    page, _ = page_of(tmp_path, note="a <rehearsal>")
    assert "://" not in page and 'src="data:' in page
    assert "a &lt;rehearsal&gt;" in page and "<x>" not in page
    again, _ = page_of(tmp_path / "again", note="a <rehearsal>")
    assert page == again


def test_every_figure_can_be_drawn_by_another_process():
    for number, draw in FIGURES.items():
        assert cloudpickle.loads(cloudpickle.dumps(draw)).__doc__ == draw.__doc__, number
