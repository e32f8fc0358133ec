"""Objects of meshes get mass, centre of mass and inertia from the hull that touches things."""

from pathlib import Path

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.language.world import ObjectSpec
from harness.world.objects import resolve_object


def box_file(folder: Path, low, high) -> str:
    """An OBJ file of a box between two corners."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1])
               for z in (low[2], high[2])]  # fmt: skip
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    for face in faces:
        a, b, c, d = face.split()
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    (folder / "box.obj").write_text("\n".join(lines) + "\n")
    return "box.obj"


def resolved(folder, **words):
    spec = ObjectSpec.model_validate({"name": "part"} | words)
    return resolve_object(spec, SE3.identity(), folder)


@pytest.mark.parametrize(
    ("low", "high", "scale", "mass"),
    [
        ((-0.02, -0.03, -0.05), (0.02, 0.03, 0.05), 1, None),
        ((0, 0, 0), (40, 60, 100), 0.001, 0.12),
        ((1, 2, 3), (2, 4, 4), (0.01, 0.02, 0.1), 0.3),
    ],
)
def test_a_mesh_of_a_box_weighs_what_the_box_weighs(tmp_path, low, high, scale, mass):
    factors = np.array(scale if isinstance(scale, tuple) else (scale, scale, scale))
    size = (np.array(high) - np.array(low)) * factors
    stated = {} if mass is None else {"mass": mass}
    mesh = resolved(
        tmp_path, mesh={"file": box_file(tmp_path, low, high), "scale": scale}, **stated
    )
    box = resolved(tmp_path, box={"size": size.tolist()}, **stated)
    assert mesh.mass == pytest.approx(box.mass, rel=1e-6)
    assert mesh.center_of_mass == pytest.approx((np.array(low) + high) / 2 * factors, abs=1e-9)
    assert mesh.inertia == pytest.approx(box.inertia, rel=1e-6, abs=1e-12)


def test_a_mesh_next_to_a_box_moves_the_centre_of_mass(tmp_path):
    file = box_file(tmp_path, (0, 0, 0), (0.1, 0.1, 0.1))
    part = resolved(
        tmp_path,
        shapes=[
            {"mesh": {"file": file}, "pose": {"xyz": [0, 0, 0.2]}},
            {"box": {"size": [0.1, 0.1, 0.1]}, "pose": {"xyz": [0.05, 0.05, 0.05]}},
        ],
    )
    assert part.mass == pytest.approx(2.0)
    assert part.center_of_mass == pytest.approx([0.05, 0.05, 0.15])


def test_a_stated_inertia_is_kept_for_a_mesh(tmp_path):
    file = box_file(tmp_path, (0, 0, 0), (0.1, 0.1, 0.1))
    inertia = {"ixx": 0.001, "iyy": 0.002, "izz": 0.0015}
    part = resolved(tmp_path, mesh={"file": file}, mass=0.5, inertia=inertia)
    assert part.mass == 0.5
    assert np.diag(part.inertia) == pytest.approx([0.001, 0.002, 0.0015])
