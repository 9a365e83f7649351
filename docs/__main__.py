"""Builds the site of the documentation, with its tutorials executed: `python -m docs [FOLDER]`.

Needs the extra `docs`. A warning is an error. Without a folder it is in build/site.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
START = (
    '<!doctype html><meta http-equiv="refresh" content="0; url=docs/README.html"><title>tribocosim</title>\n'
)


def main() -> int:
    """The status of Sphinx, 0 if the site is whole."""
    try:
        from sphinx.cmd.build import main as build
    except ImportError:
        print("the site needs the extra docs: python -m pip install --editable '.[docs]'", file=sys.stderr)
        return 2
    site = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "site").resolve()
    status = build(["-W", "--keep-going", "--quiet", "-c", str(ROOT / "docs"), str(ROOT), str(site)])
    if status == 0:
        (site / "index.html").write_text(START, encoding="utf-8")
        print(site / "index.html")
    return status


if __name__ == "__main__":
    sys.exit(main())
