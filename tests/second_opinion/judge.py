"""A slow and simple judge of the random runs: geometry and a balance of forces from raw states.

It reads joint positions and the thing's pose, which are MuJoCo's raw state, and shares no code with
the verdicts: distances come from a model of its own, forces from mass times acceleration, and the
limits are written out again. `None` is no opinion.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from harness.recording.run import Run
from tests.second_opinion.runs import (
    BIN,
    BOARDS,
    FINGER,
    FINGER_DROP,
    GRAVITY,
    PALM,
    TIPS,
    WALL,
    Trial,
)

FAR = 0.15
TIE = 3e-4
RECENT = 0.01
HOLD = 0.1
FINGERS = ("finger_left", "finger_right")
LINKS = ("palm", *FINGERS)


def _halves(size) -> str:
    return " ".join(str(side / 2) for side in size)


def _model(trial: Trial) -> mujoco.MjModel:
    """The same scene, written by hand: every body is placed, nothing is simulated."""
    boards = "".join(
        f'<geom name="bin{k}" type="box" size="{_halves(size)}" pos="{np.add(BIN, at)[0]}'
        f' {np.add(BIN, at)[1]} {np.add(BIN, at)[2]}"/>'
        for k, (size, at) in enumerate(BOARDS)
    )
    thing = (
        f'type="box" size="{_halves(trial.size)}"'
        if trial.shape == "box"
        else f'type="sphere" size="{trial.size[0] / 2}"'
    )
    bodies = "".join(
        f'<body name="{name}" mocap="true"><geom name="{name}" {geom}/></body>'
        for name, geom in (
            ("thing", thing),
            ("palm", f'type="box" size="{_halves(PALM)}"'),
            *((name, f'type="box" size="{_halves(FINGER)}"') for name in FINGERS),
        )
    )
    wall = " ".join(map(str, WALL["at"]))
    return mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody>"
        '<geom name="floor" type="plane" size="2 2 0.1"/>'
        f'<geom name="wall" type="box" size="{_halves(WALL["size"])}" pos="{wall}"/>'
        f"{boards}{bodies}</worldbody></mujoco>"
    )


def _matrix(quat: np.ndarray) -> np.ndarray:
    """The rotation matrix of a unit quaternion wxyz."""
    found = np.zeros(9)
    mujoco.mju_quat2Mat(found, quat)
    return found.reshape(3, 3)


@dataclass(eq=False)
class Judge:
    """What it measures of a run."""

    trial: Trial
    run: Run

    def __post_init__(self) -> None:
        signals = self.run.signals
        self.times, self.step = signals.times, self.run.timestep
        names = list(self.run.robot.joint_names)
        self.q = {name: signals.joint_positions[:, k] for k, name in enumerate(names)}
        self.pose = signals.object_poses["thing"]
        self.palm = np.column_stack([self.q["slide"], np.zeros(len(self.times)), self.q["lift"]])
        self.distances = self._distances()
        position = self.pose[:, :3]
        self.acceleration = np.zeros_like(position)
        self.acceleration[1:-1] = np.diff(position, 2, axis=0) / self.step**2
        self.force = self.trial.mass * (self.acceleration + np.array([0, 0, GRAVITY]))

    def _distances(self) -> dict[tuple[str, str], np.ndarray]:
        model = _model(self.trial)
        data = mujoco.MjData(model)
        others = ("floor", "wall", *(f"bin{k}" for k in range(len(BOARDS))))
        pairs = [("thing", name) for name in (*LINKS, *others)]
        pairs += [(link, "wall") for link in LINKS]
        ids = [(model.geom(a).id, model.geom(b).id) for a, b in pairs]
        rows = {name: int(model.body(name).mocapid[0]) for name in ("thing", *LINKS)}
        measured = np.empty((len(self.times), len(pairs)))
        for k in range(len(self.times)):
            data.mocap_pos[rows["thing"]] = self.pose[k, :3]
            data.mocap_quat[rows["thing"]] = self.pose[k, 3:]
            data.mocap_pos[rows["palm"]] = self.palm[k]
            for name, sign in zip(FINGERS, (1, -1), strict=True):
                side = sign * (FINGER[1] / 2 + self.q[name.removeprefix("finger_")][k])
                data.mocap_pos[rows[name]] = self.palm[k] + (0, side, -FINGER_DROP)
            mujoco.mj_kinematics(model, data)
            measured[k] = [mujoco.mj_geomDistance(model, data, a, b, FAR, None) for a, b in ids]
        found = {pair: measured[:, k] for k, pair in enumerate(pairs)}
        found["thing", "bin"] = np.min(
            [found.pop(("thing", f"bin{k}")) for k in range(len(BOARDS))], axis=0
        )
        return found

    def touches(self, name: str) -> np.ndarray:
        """Samples at which the thing touched a body within the last 10 ms."""
        return self._recently(self.distances["thing", name] <= 0)

    def _recently(self, mask: np.ndarray) -> np.ndarray:
        count = round(RECENT / self.step) + 1
        return np.convolve(mask, np.ones(count))[: len(mask)] > 0

    def _mean(self, values: np.ndarray, span: float) -> np.ndarray:
        count = round(span / self.step) + 1
        padded = np.concatenate([np.repeat(values[:1], count - 1, axis=0), values])
        return np.convolve(padded, np.ones(count) / count, mode="valid")

    def pinched(self) -> np.ndarray:
        """Samples at which both fingers touch the thing and its centre is between their faces.

        Tips that stand on top of it touch it too: a ball is pinched up to 45 degrees above its
        middle, where the cone of a friction of 1 ends, and a box by more than 1 mm below its top.
        """
        y, z = self.pose[:, 1], self.pose[:, 2]
        between = (y < self.q["left"]) & (y > -self.q["right"])
        if self.trial.shape == "ball":
            top = z + np.sqrt(0.5) * self.trial.size[2] / 2
        else:
            w, i, j, k = self.pose[:, 3:].T
            upward = np.abs([2 * (i * k - w * j), 2 * (j * k + w * i), 1 - 2 * (i * i + j * j)])
            top = z + upward.T @ np.array(self.trial.size) / 2 - 1e-3
        between &= top > self.palm[:, 2] - TIPS
        return self.touches("finger_left") & self.touches("finger_right") & between

    def held(self) -> np.ndarray:
        """Pinched for 0.1 s, and within it still in the frame of the palm to 5 mm."""
        pinched, count = self.pinched(), round(HOLD / self.step)
        since = np.zeros(len(pinched), dtype=int)
        for k in range(1, len(pinched)):
            since[k] = since[k - 1] + 1 if pinched[k] and pinched[k - 1] else 0
        local = self.pose[:, :3] - self.palm
        earlier = local[np.maximum(np.arange(len(local)) - count, 0)]
        self.since = since
        return (since >= count) & (np.linalg.norm(local - earlier, axis=1) <= 0.005)

    def grasped(self) -> bool:
        """Held at the end; between the fingers it moved and turned little since the pinch began."""
        if not self.held()[-1]:
            return False
        began = -1 - self.since[-1]
        quats = self.pose[began:, 3:]
        turned = 2 * np.arccos(min(1.0, abs(float(quats[0] @ quats[-1]))))
        point = self._between_fingers(began)
        turns = [_matrix(quat) for quat in (quats[0], quats[-1])]
        moved = (turns[1] - turns[0]) @ turns[0].T @ (point - self.pose[began, :3])
        local = self.pose[:, :3] - self.palm
        moved = moved + local[-1] - local[began]
        return bool(np.linalg.norm(moved) <= 0.005 and turned <= 0.1)

    def _between_fingers(self, sample: int) -> np.ndarray:
        """The middle of what the fingers and the upright box around the thing share [m]."""
        half = np.abs(_matrix(self.pose[sample, 3:])) @ np.array(self.trial.size) / 2
        half = half if self.trial.shape == "box" else np.full(3, self.trial.size[0] / 2)
        finger = self.palm[sample] - (0, 0, FINGER_DROP)
        reach = np.array([FINGER[0] / 2, 1.0, FINGER[2] / 2])
        thing = self.pose[sample, :3]
        low = np.maximum(thing - half, finger - reach)
        return (low + np.minimum(thing + half, finger + reach)) / 2

    def lifted(self) -> bool:
        held = self.held()
        alone = ~(self.touches("floor") | self.touches("bin") | self.touches("wall"))
        carried = self._mean(self.force[:, 2], HOLD) >= 0.5 * self.trial.mass * GRAVITY
        began = np.arange(len(held)) - self.since
        by_palm = self.palm[:, 2] - self.palm[began, 2]
        rise = np.minimum(self.pose[:, 2] - self.pose[0, 2], by_palm)
        return bool((held & alone & carried & (rise >= 0.02)).any())

    def _still(self) -> bool:
        count = round(0.05 / self.step)
        speed = np.linalg.norm(np.diff(self.pose[-count - 1 :, :3], axis=0), axis=1) / self.step
        quats = self.pose[-count - 1 :, 3:]
        dots = np.abs(np.sum(quats[1:] * quats[:-1], axis=1))
        turning = 2 * np.arccos(np.minimum(dots, 1.0)) / self.step
        rough = 2 * np.linalg.norm(np.diff(quats, axis=0), axis=1) / self.step
        turning = np.minimum(turning, rough)
        size = np.linalg.norm(self.trial.size) if self.trial.shape == "box" else self.trial.size[0]
        fastest = speed + turning * size / 2  # a bound: the farthest point from the middle
        return bool(fastest.max() <= 0.005 and turning.max() <= 0.05)

    def released(self) -> bool:
        return not any(self.touches(link)[-1] for link in LINKS)

    def placed(self) -> bool | None:
        rests = self.touches("floor")[-1] or self.touches("bin")[-1] or self.touches("wall")[-1]
        return bool(self.released() and self._still() and rests)

    def on(self, support: str) -> bool | None:
        """By the balance of forces where nothing else touches the thing.

        No support outlasts its last contact. A thing that rattles when the run ends, where the last
        accelerations decide, leaves the question open.
        """
        others = {"floor", "bin", "wall", *LINKS} - {support}
        if not (self.distances["thing", support][-1] <= 0):
            return False
        if any(self.touches(name)[-1] for name in others):
            return None
        carried = self.force[-4:-1, 2] >= 0.5 * self.trial.mass * GRAVITY
        return bool(carried[-1]) if len(set(carried.tolist())) == 1 else None

    def inside_bin(self) -> bool:
        x, y, z = self.pose[-1, :3] - BIN
        return bool(abs(x) <= 0.08 and abs(y) <= 0.08 and 0 <= z <= 0.08)

    def hits_wall(self) -> bool:
        return any(bool((self.distances[link, "wall"] <= 0).any()) for link in LINKS)

    def held_thing_hits_wall(self) -> bool:
        return bool(((self.distances["thing", "wall"] <= 0) & self.pinched()).any())

    def clear_of_wall(self) -> bool | None:
        least = min(float(self.distances[link, "wall"].min()) for link in LINKS)
        return None if abs(least - 0.08) < TIE else least >= 0.08

    def _is_struck(self) -> bool:
        """Whether the thing meets the hand, or in the hand another body, with 10 g or more.

        How much of such a blow the grip explains cannot be seen from the states.
        """
        near = np.any([self.touches(link) for link in LINKS], axis=0)
        return bool((np.linalg.norm(self.acceleration, axis=1)[near] > 10 * GRAVITY).any())

    def knocks(self) -> bool | None:
        """A link touches the thing while it neither grips it nor rests after gripping it.

        Once pinched, it may slip out between the fingers while both touch it. A pinch of less than
        30 ms is a blow on the edges of the tips: no opinion.
        """
        pinched = self.pinched()
        if 0 < pinched.sum() * self.step < 0.03 or self._is_struck():
            return None
        grips = np.zeros(len(pinched), dtype=bool)
        rests = grips.copy()
        for record in self.run.steps:
            span = slice(record.start_index, record.end_index)
            if record.verb == "gripper" and pinched[max(span.start - 1, 0) : span.stop + 1].any():
                grips[span] = True
            if record.verb in ("gripper", "wait"):
                rests[span] = True
        both = self.touches("finger_left") & self.touches("finger_right")
        touching = np.any([self.distances["thing", link] <= 0 for link in LINKS], axis=0)
        near = self._recently(touching)
        excused, going = np.zeros(len(pinched), dtype=bool), False
        for k in range(len(pinched)):
            going = near[k] and (going or grips[k]) and (both[k] or rests[k])
            excused[k] = going
        return bool((touching & ~excused).any())

    def opinions(self) -> dict[str, bool | None]:
        """By the names of `EXPECTATIONS`."""
        return {
            "grasped": self.grasped(),
            "lifted": self.lifted(),
            "placed": self.placed(),
            "on bin": self.on("bin"),
            "on floor": self.on("floor"),
            "in bin": self.inside_bin(),
            "released": self.released(),
            "collision with the thing": self.knocks(),
            "collision with the wall": self.hits_wall(),
            "thing in hand hits the wall": self.held_thing_hits_wall(),
            "clearance": self.clear_of_wall(),
        }
