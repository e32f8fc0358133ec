"""Pictures corrupted in every way, for the mutation check of `sees`."""

from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np

from harness.core.spatial import SE3
from harness.plugins.cameras.expectations.sees import Sees
from harness.plugins.cameras.looks import Look
from tests.cameras.camera_runs import ball, card, eye, pictures, run_with
from tests.judging.synthetic_run import step

AHEAD, ASIDE = (0.6, 0.0, 1.0), (0.6, 1.5, 1.0)
FACING_BACK = SE3.from_xyz_rpy(AHEAD, (np.pi / 2, 0, -np.pi / 2))
SUBJECTS = {
    "object": ({"object": "thing"}, lambda: ball("thing", AHEAD, 0.05)),
    "color": ({"color": "red"}, lambda: ball("thing", AHEAD, 0.05)),
    "marker": ({"marker": 3}, lambda: card("thing", {"id": 3, "size": 0.1}, FACING_BACK)),
}
STEPS = (step("early", 0, 1), step("late", 1, 2))


@lru_cache
def seen_run(kind):
    """A thing that stands aside before the window and ahead of the camera in it."""
    words, make = SUBJECTS[kind]
    thing = make()
    rows = np.stack([thing.pose.as_vector()] * 2)
    rows[0, :3] = ASIDE
    run, objects = run_with([eye()], [thing], poses={"thing": rows}, steps=STEPS)
    looks = [Look("eye", sample, ("color", "segmentation"), "shot") for sample in (0, 1)]
    return Sees(camera="eye", **words), pictures(run, objects, *looks), "late"


def corrupted(run, spec):
    """Kind and run of each mutant of what `sees` reads."""
    kind = "segmentation" if spec.object else "color"
    before, shot = run.captures
    name = shot.files[kind]

    def with_file(content):
        return replace(run, files={**run.files, name: content})

    def with_shot(**fields):
        return replace(run, captures=(before, replace(shot, **fields)))

    picture = cv2.imdecode(np.frombuffer(run.files[name], np.uint8), cv2.IMREAD_UNCHANGED)
    yield "shift", with_file(_png(picture[:, :8]))  # what is in the middle is out of it
    yield "freeze", with_file(run.files[before.files[kind]])
    yield "freeze", with_shot(sample=before.sample, time=before.time)
    yield "drop", replace(run, captures=(before,))
    yield "drop", with_shot(files={})
    yield "drop", replace(run, cameras=())
    yield "NaN", with_file(_png(np.zeros_like(picture)))
    if spec.object:
        yield "shift", with_shot(labels={key: n + 1 for key, n in shot.labels.items()})
        yield "shift", with_shot(outlines={key: 9 * n for key, n in shot.outlines.items()})
        yield "drop", with_shot(labels={})
        yield "drop", with_shot(outlines={})


def _png(picture):
    return cv2.imencode(".png", picture)[1].tobytes()
