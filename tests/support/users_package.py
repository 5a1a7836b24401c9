"""Distributions that a user would install beside rvbench, and an environment to install them in."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
TIME_LIMIT_S = HANGS_S


def fresh_environment(folder: Path) -> Path:
    """Make an environment that has what this one has, and return its Python."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    ours = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    site = next(folder.glob("lib/python*/site-packages"))
    (site / "what_this_one_has.pth").write_text("".join(f"{path}\n" for path in sorted(ours)))
    return folder / "bin" / "python"


def install(python: Path, package: Path) -> None:
    """Install a package's folder as a user would; nothing is fetched."""
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet"]
    offline = ["--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    subprocess.run([*pip, *offline, str(package)], check=True, timeout=TIME_LIMIT_S)


def lay_out(site: Path, module: str, text: str, entry_points: str) -> Path:
    """Write a distribution of one module as it lies when installed; return the folder of it.

    Parameters
    ----------
    site : Path
        To be put on the search path.
    module, text : str
        Name of the module, and its code.
    entry_points : str
        What ``entry_points.txt`` says.
    """
    about = site / f"{module}-1.0.dist-info"
    about.mkdir(parents=True)
    (site / f"{module}.py").write_text(text)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(entry_points)
    return site


def rvbench(
    *arguments: object, python: Path | str = sys.executable, sites: tuple[Path, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Run ``python -m bench.cli`` with distributions on the path."""
    return subprocess.run(
        [str(python), "-m", "bench.cli", *map(str, arguments)],
        cwd=HOUSE,
        env=environment(*sites),
        capture_output=True,
        text=True,
        check=False,
        timeout=TIME_LIMIT_S,
    )


def environment(*sites: Path) -> dict[str, str]:
    """Return the variables of a process that finds the house and these distributions."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (HOUSE, *sites)))}
