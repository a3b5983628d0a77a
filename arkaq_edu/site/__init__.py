"""The whole course as pages that need no Python: `arkaq site`.

- `build`: `site`, which writes them;
- `chapters`: the notebooks as they ran;
- `reference`, `tables`: reference, environments, gallery, trace, benchmarks, home;
- `living`: the explorers, with what they show at every stop of their controls;
- `robots`: the live robot, in recorded episodes; `packing`: data in the form of a script;
- `links`: what a page must not have: a link to nowhere, a request to elsewhere.

Sphinx makes the pages with the settings and the look that are in the folder ``site`` of a clone.
"""
