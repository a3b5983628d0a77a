"""What pages must not have: links to nowhere, and requests to elsewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: The most that a page may weigh with all that it loads, and all pages together (bytes).
PAGE, SITE = 8_000_000, 60_000_000

#: What a browser loads by itself, by element and attribute.
_LOADS = {
    ("img", "src"), ("script", "src"), ("source", "src"), ("video", "src"), ("iframe", "src"),
    ("audio", "src"), ("embed", "src"), ("object", "data"), ("video", "poster"), ("link", "href"),
    ("div", "data-src"),
}  # fmt: skip
_PASSIVE = {"canonical", "next", "prev", "search", "index", "author", "license", "help"}
_IN_STYLES = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")


class _Page(HTMLParser):
    """The anchors, the links and the loads of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        for name, value in given.items():
            if (tag, name) in _LOADS and given.get("rel", "") not in _PASSIVE:
                self.loads.append(value)
            elif name == "href":
                self.links.append(value)
            elif name == "style":
                self.loads += _urls(value)


def _urls(style: str) -> list[str]:
    return [first or second for first, second in _IN_STYLES.findall(style)]


def problems(folder: Path | str) -> list[str]:
    """Say what is wrong with the pages in a folder: broken links, outside requests, weights.

    Parameters
    ----------
    folder : path
        The folder of a site.

    Returns
    -------
    list of str
        A line each: the page, and what is wrong.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "a.html").write_text('<a href="b.html">b</a><img src="http://x/y">')
    ...     problems(folder)
    ['a.html: no file for b.html', 'a.html: asks elsewhere for http://x/y']
    """
    root = Path(folder).resolve()
    pages = {path: _Page(path.read_text(encoding="utf-8")) for path in sorted(root.rglob("*.html"))}
    found: list[str] = []
    for path, page in pages.items():
        name = path.relative_to(root).as_posix()
        found += [f"{name}: {words}" for words in _broken(path, page, pages)]
        found += [f"{name}: asks elsewhere for {url}" for url in page.loads if _outside(url)]
        if (size := _weight(path, page)) > PAGE:
            found.append(f"{name}: weighs {size / 1e6:.1f} MB with what it loads")
    for path in sorted(root.rglob("*.css")):
        urls = [url for url in _urls(path.read_text(encoding="utf-8")) if _outside(url)]
        found += [f"{path.relative_to(root).as_posix()}: asks elsewhere for {url}" for url in urls]
    total = sum(path.stat().st_size for path in root.rglob("*") if path.is_file())
    if total > SITE:
        found.append(f"all pages: weigh {total / 1e6:.0f} MB")
    return found


def _outside(url: str) -> bool:
    return urlsplit(url).scheme in ("http", "https") or url.startswith("//")


def _target(path: Path, url: str) -> Path:
    return (path.parent / unquote(urlsplit(url).path)).resolve() if urlsplit(url).path else path


def _broken(path: Path, page: _Page, pages: dict[Path, _Page]) -> list[str]:
    found = []
    for url in dict.fromkeys(page.links + page.loads):
        if urlsplit(url).scheme or url.startswith("//"):
            continue
        target, anchor = _target(path, url), unquote(urlsplit(url).fragment)
        if not target.is_file():
            found.append(f"no file for {url}")
        elif anchor and target in pages and anchor not in pages[target].anchors:
            found.append(f"no place for {url}")
    return found


def _weight(path: Path, page: _Page) -> int:
    own = {_target(path, url) for url in page.loads if not urlsplit(url).scheme}
    return path.stat().st_size + sum(file.stat().st_size for file in own if file.is_file())
