"""A UR's calibration file."""

# A ur5e out of its nominal place by tenths of a millimetre and milliradians, as the arms are; the
# forearm written with three half turns, as ur_calibration writes it.
SECTIONS = {
    "shoulder": (0.0, 0.0, 0.16261, 0.0, 0.0, 2e-05),
    "upper_arm": (0.00021, 0.0, 0.0, 1.57013, 0.0, -1.1e-05),
    "forearm": (-0.42514, 0.0, 0.0, 3.14031, 3.14099, 3.14157),
    "wrist_1": (-0.39212, -0.0011, 0.13352, 0.0083, 0.0007, 1e-05),
    "wrist_2": (0.00004, -0.09968, 0.00006, 1.57022, 0.0, -2e-05),
    "wrist_3": (0.00006, 0.09941, 0.00003, 1.57012, 3.14159265, -3.14153),
}
KEYS = ("x", "y", "z", "roll", "pitch", "yaw")


def calibration_text(sections=SECTIONS):
    """The file, as ur_calibration writes it."""
    lines = ["kinematics:"]
    for name, values in sections.items():
        lines += [f"  {name}:"] + [f"    {k}: {v!r}" for k, v in zip(KEYS, values, strict=True)]
    return "\n".join([*lines, "  hash: calib_1"]) + "\n"
