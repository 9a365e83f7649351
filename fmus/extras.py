"""How an extra of this installation is added."""

import shlex
import sys
from pathlib import Path


def tell_install(extra: str) -> str:
    """The command that adds an extra to this installation, a clone or a package."""
    home = Path(__file__).resolve().parents[1]
    what = f"--editable '{home}[{extra}]'" if (home / "pyproject.toml").exists() else f"'tribocosim[{extra}]'"
    return f"{shlex.quote(sys.executable)} -m pip install {what}"
