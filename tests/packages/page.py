"""The page on robots of other packages. Run as a script, it tries them and writes it.

Names of packages as arguments try those alone, and `picks` the arms with fingers; other lines of
the page stay as they are.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.packages.arms import ARMS, ELSEWHERE, OTHERS, PACKAGES, WITH_GRIPPER, PackageArm
from tests.packages.trial import PickTrial, Trial, try_arm, try_pick

PAGE = Path(__file__).parents[2] / "docs/reference/robot_packages.md"
RENEW = "python -m tests.packages.page"

HEAD = """# Robots of other packages

This page lists arms with a fixed base in seven packages of the Python registry. A scenario names
such an arm like this:

```yaml
robot:
  urdf: package://example-robot-data/robots/panda_description/urdf/panda.urdf
  srdf: package://example-robot-data/robots/panda_description/srdf/panda.srdf
```

Each arm is loaded with its own SRDF, where that matches the URDF. The positions of all links at
random joint positions, and the masses, agree between MuJoCo and Pinocchio's own reading of the file
to 1e-9 m and 1e-9 kg; masses that a file lacks are estimated from volumes. Then one `move_to` to a
random collision-free state is planned and executed within the limits: the first of at most ten
states that can be reached. (Not every state can be reached: with joints of two turns, some free
regions are not connected.)

```sh
pip install -e '.[packages]'
python -m pytest -m needs_packages    # tries all arms, and compares them with this page
python -m tests.packages.page         # tries all arms, and writes this page
```
"""

PICKS = """## Picks

For each arm with fingers, `harness robot check` looks it over, and `harness new` writes a scenario
that takes a box from a stand, checks it and runs it. It passes unchanged, or the table says why it
does not.

| robot | wrong in its file | picks a box | reason |
| --- | --- | --- | --- |"""


def row(arm: PackageArm, trial: Trial) -> str:
    """The arm's line of the table."""
    mass = "" if trial.mass != trial.mass else f"{trial.mass:.3f}"
    if trial.is_mass_estimated:  # volumes of convex parts differ by rounding between processors
        mass = f"{trial.mass:.3g} (estimated)"
    joints = trial.joints or ""
    moved = "yes" if trial.moved else "no"
    reason = trial.reason.replace("|", "/")
    srdf = trial.srdf.replace("|", "/")
    cells = f"`{arm.file}`", joints, mass, srdf, moved, reason
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def pick_row(arm: PackageArm, trial: PickTrial) -> str:
    """The arm's line in the table of picks."""
    picks = "yes" if trial.picks else "no"
    cells = f"`{arm.name}`", "; ".join(trial.wrong), picks, trial.reason
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"


def page(rows: dict[str, str], picks: dict[str, str]) -> str:
    """The page, from each arm's line, and the lines of those with fingers."""
    parts = [HEAD]
    for name, package in PACKAGES.items():
        parts.append(f"## {name}\n\n[{package.source}]({package.source}); {package.licence}.\n")
        parts.append("| robot | joints | mass [kg] | SRDF | moved | reason |")
        parts.append("| --- | --- | --- | --- | --- | --- |")
        parts += [rows[arm.name] for arm in ARMS if arm.package == name and arm.name in rows]
        others = "; ".join(
            f"{what}: {', '.join(f'`{path}`' for path in paths.split())}"
            for what, paths in OTHERS[name].items()
        )
        parts.append(f"\nNot tried: {others}.\n")
    parts += [PICKS, *(picks[arm.name] for arm in WITH_GRIPPER if arm.name in picks)]
    parts.append("\n## Other packages\n\nThese are not tried with each release:\n")
    parts += [f"- {names}: {what}." for names, what in ELSEWHERE.items()]
    return "\n".join(parts) + "\n"


def written() -> tuple[dict[str, str], dict[str, str]]:
    """The lines of the page as it is, of arms and of picks, by the arms' names."""
    text = PAGE.read_text(encoding="utf-8")
    rows: dict[str, str] = {}
    for section in text.split("\n## ")[1:]:
        title = section.partition("\n")[0]
        for line in section.splitlines():
            if line.startswith("| `"):
                rows[f"{title}: {line.split('`')[1]}"] = line
    names = [name for name in rows if name.startswith("Picks: ")]
    picks = {name.removeprefix("Picks: "): rows.pop(name) for name in names}
    return rows, picks


def renew(words: list[str]) -> None:
    """Try arms, and write the page after each."""
    rows, picks = written()
    for table, arms in ((rows, ARMS), (picks, WITH_GRIPPER)):
        for arm in arms:
            if words and ("picks" if table is picks else arm.package) not in words:
                continue
            with tempfile.TemporaryDirectory() as folder:
                if table is rows:
                    rows[arm.name] = row(arm, try_arm(arm, Path(folder)))
                else:
                    picks[arm.name] = pick_row(arm, try_pick(arm, Path(folder)))
            PAGE.write_text(page(rows, picks), encoding="utf-8")


if __name__ == "__main__":
    renew(sys.argv[1:])
