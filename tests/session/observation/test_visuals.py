"""The triangles of mesh files that a run keeps for its pictures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh

from harness.core.geometry import Mesh, Shape
from harness.session.observation.visuals import mesh_records
from tests.judging.synthetic_run import BOX, ROBOT, TABLE, make_run


def test_each_mesh_of_links_and_objects_is_kept_once(tmp_path):
    shapes = []
    for number in (1, 2):
        path = tmp_path / f"part_{number}.stl"
        trimesh.creation.box((number, 1.0, 1.0)).export(path)
        shapes.append(Shape(Mesh(path, (1.0, 1.0, 1.0))))
    part, other = shapes
    drawn = {"palm": (part,), "arm_link": (TABLE.shapes[0], part)}
    links = tuple(replace(link, visuals=drawn.get(link.name, ())) for link in ROBOT.links)
    robot = replace(ROBOT, links=links)
    cup = replace(BOX, name="cup", visuals=(other, part))
    records = mesh_records(make_run(2, objects=(TABLE, cup), robot=robot))
    assert [Path(record.path) for record in records] == [shape.geometry.path for shape in shapes]
    assert [float(np.ptp(record.vertices[:, 0])) for record in records] == [1.0, 2.0]
    assert mesh_records(make_run(2)) == ()
