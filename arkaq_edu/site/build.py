"""From a clone to a folder of pages: `arkaq site`."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from arkaq_edu._paths import course_folder, in_repository
from arkaq_edu.site.chapters import PICTURES, masters, write_chapter
from arkaq_edu.site.links import problems
from arkaq_edu.site.living import write_explorers
from arkaq_edu.site.reference import write_environments, write_reference
from arkaq_edu.site.tables import write_benchmarks, write_gallery, write_home, write_trace

#: The pages of the clone that are pages of the site as they are.
AS_THEY_ARE = ("TEACHING.md", "environment.md", "CONTRIBUTING.md", "CHANGELOG.md", "data/README.md")
#: Files that those pages link to.
LINKED = ("LICENSE", "CITATION.cff")


def site(out: Path | str) -> list[str]:
    """Write the whole course as static pages.

    They open from a disk and from any web server, ask nothing of any other address, and need no
    Python. The explorers follow their sliders there.

    Parameters
    ----------
    out : path
        A folder that does not exist yet, is empty, or holds an earlier site.

    Returns
    -------
    list of str
        What was written, a line each.

    Raises
    ------
    ValueError
        If the package does not run from a clone, the folder holds something else, or a page has a
        link to nowhere.
    """
    out = Path(out)
    if not in_repository():
        raise ValueError("the site is made in a clone of the repository: a wheel has no outputs")
    if out.exists() and any(out.iterdir()) and not (out / "objects.inv").exists():
        raise ValueError(f"{out} holds files already: name a new folder")
    with tempfile.TemporaryDirectory() as folder:
        sources, pages = Path(folder) / "sources", Path(folder) / "pages"
        write_sources(sources)
        make_pages(sources, pages)
        wrong = problems(pages)
        if wrong:
            raise ValueError(f"{len(wrong)} faults in the pages: {'; '.join(wrong[:9])}")
        if out.exists():
            shutil.rmtree(out)
        shutil.move(pages, out)
    files = [path for path in out.rglob("*") if path.is_file()]
    size = sum(path.stat().st_size for path in files) / 1e6
    n = sum(path.suffix == ".html" for path in files)
    return [f"{out / 'index.html'}: {n} pages, {size:.0f} MB, no broken link, no request outside"]


def write_sources(folder: Path) -> None:
    """Write the sources of all pages to a new folder."""
    root, pictures = course_folder(), folder / PICTURES
    pictures.mkdir(parents=True)
    shutil.copytree(root / "notebooks" / "img", folder / "notebooks" / "img")
    for master in masters():
        write_chapter(master, folder / "notebooks", pictures)
    for name in (*AS_THEY_ARE, *LINKED):
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copy(root / name, folder / name)
    write_reference(folder / "reference")
    write_environments(folder / "environments", pictures)
    write_trace(folder / "trace.md")
    write_gallery(folder / "gallery.md", pictures)
    write_home(folder / "index.md", write_benchmarks(folder / "benchmarks.md", pictures))
    write_explorers(folder / "_static")


def make_pages(sources: Path, out: Path) -> None:
    """Let Sphinx make the pages; a warning is an error."""
    from sphinx.cmd.build import main as sphinx

    settings = course_folder() / "site"
    with tempfile.TemporaryDirectory() as trees:
        arguments = ["-W", "--keep-going", "-q", "-c", settings, "-d", trees, sources, out]
        if sphinx([str(each) for each in arguments]):
            raise ValueError("Sphinx found faults in the pages; they are named above")
