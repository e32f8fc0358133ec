"""Runs by hand with cameras: a still arm, objects that stand or move, 100 samples a second."""

from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np

from harness.core.camera import Camera
from harness.core.geometry import Shape, Sphere
from harness.core.spatial import SE3
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.language.cameras import looking_at
from harness.language.scenario import RobotSpec
from harness.plugins.cameras.captures import take_pictures
from harness.plugins.cameras.keys.marker import MarkerSpec
from harness.plugins.cameras.looks import Look, merged_looks
from harness.plugins.cameras.watched import looks_of_expectations
from harness.robot.load import load_robot
from tests.cameras.recorded_runs import GROUND, an_object
from tests.judging.synthetic_run import make_run

RED, GREEN = (0.9, 0.05, 0.05, 1.0), (0.05, 0.8, 0.05, 1.0)
SMALL = {"width": 160, "height": 120}


@lru_cache
def robot():
    """The OpenMANIPULATOR-X on the ground, out of the way of what is looked at."""
    return load_robot(RobotSpec(model="open_manipulator_x", base={"xyz": [-3.0, 0, 0]}))


def eye(xyz=(0.0, 0.0, 1.0), target=(1.0, 0.0, 1.0), *, name="eye", frame="world", **fields):
    """A camera at a place, looking at another."""
    return Camera(name, frame, looking_at(xyz, target), **{**SMALL, **fields})


def ball(name, xyz, radius=0.02, rgba=RED, **fields):
    """A ball whose centre is a point to find again."""
    return replace(
        an_object(name, (1, 1, 1), xyz, rgba, **fields),
        shapes=(Shape(Sphere(radius), rgba=rgba),),
    )


def card(name, marker, pose):
    """A printed marker."""
    spec = MarkerSpec(**marker)
    thing = an_object(name, (1, 1, 1), (0, 0, 0), RED)
    return replace(thing, shapes=(Shape(spec.solid()),), visuals=spec.printed(SE3.identity(), ""),
                   pose=pose)  # fmt: skip


def run_with(cameras, objects, n=2, poses=None, seed=7, description=None, **options):
    """A run in which objects stand where they are, but for the poses given, shape (n, 7) each."""
    description = description or robot()
    objects = (GROUND, *objects)
    rows = {obj.name: np.tile(obj.pose.as_vector(), (n, 1)) for obj in objects}
    run = make_run(n, objects=(), **options)
    signals = replace(
        run.signals,
        joint_positions=np.tile(description.start_positions(), (n, 1)),
        object_poses={**rows, **(poses or {})},
    )
    return replace(run, seed=seed, signals=signals, cameras=tuple(cameras)), objects


def pictures(run, objects, *looks, description=None):
    """The run with some pictures taken."""
    captures, files = take_pictures(description or robot(), objects, run, merged_looks(looks))
    return replace(run, captures=captures, files=files)


def every(camera="eye", sample=0, step="shot"):
    """All kinds of pictures."""
    return Look(camera, sample, ("color", "depth", "segmentation"), step)


def verdict(run, objects, spec, step=""):
    """An expectation's verdict, from the pictures that it requests itself."""
    placed = [PlacedExpectation(spec, step)]
    looks = looks_of_expectations(run, placed)
    (answer,) = judge(pictures(run, objects, *looks), placed)
    return answer


def image(run, kind, index=0):
    """A picture of a capture as OpenCV reads it (BGR)."""
    content = run.files[run.captures[index].files[kind]]
    return cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
