"""The page on robots of other packages. Run as a script, it tries all of them and writes it."""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.packages.arms import ARMS, OTHERS, PACKAGES, PackageArm
from tests.packages.trial import Trial, try_arm

PAGE = Path(__file__).parents[2] / "docs/reference/robot_packages.md"
RENEW = "python -m tests.packages.page"

HEAD = """# Robots of other packages

This page lists every arm with a fixed base in three packages of the Python registry. A scenario
names such an arm like this:

```yaml
robot:
  urdf: package://example-robot-data/robots/panda_description/urdf/panda.urdf
  srdf: package://example-robot-data/robots/panda_description/srdf/panda.srdf
```

Each arm is loaded with its own SRDF, where that matches the URDF. The positions of all links at
random joint positions, and the masses, agree between MuJoCo and Pinocchio's own reading of the file
to 1e-9 m and 1e-9 kg. Then one `move_to` to a random collision-free state is planned and executed
within the limits: the first of at most ten states that can be reached. (Not every state can be
reached: with joints of two turns, some free regions are not connected.)

```sh
pip install 'armharness[packages]'
python -m pytest -m packages          # tries all arms, and compares them with this page
python -m tests.packages.page         # tries all arms, and writes this page
```
"""


def row(arm: PackageArm, trial: Trial) -> str:
    """The arm's line of the table."""
    mass = "" if trial.mass != trial.mass else f"{trial.mass:.3f}"
    joints = trial.joints or ""
    moved = "yes" if trial.moved else "no"
    reason = trial.reason.replace("|", "/")
    srdf = trial.srdf.replace("|", "/")
    cells = f"`{arm.file}`", joints, mass, srdf, moved, reason
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def page(rows: dict[str, str]) -> str:
    """The page, from each arm's line."""
    parts = [HEAD]
    for name, package in PACKAGES.items():
        parts.append(f"## {name}\n\n[{package.source}]({package.source}); {package.licence}.\n")
        parts.append("| robot | joints | mass [kg] | SRDF | moved | reason |")
        parts.append("| --- | --- | --- | --- | --- | --- |")
        parts += [rows[arm.name] for arm in ARMS if arm.package == name]
        others = "; ".join(
            f"{what}: {', '.join(f'`{path}`' for path in paths.split())}"
            for what, paths in OTHERS[name].items()
        )
        parts.append(f"\nWithout an arm on a fixed base: {others}.\n")
    return "\n".join(parts)


if __name__ == "__main__":
    found: dict[str, str] = {}
    for arm in ARMS:
        with tempfile.TemporaryDirectory() as folder:
            found[arm.name] = row(arm, try_arm(arm, Path(folder)))
    PAGE.write_text(page(found), encoding="utf-8")
