"""The reference of robot.yaml as Markdown, made from its model."""

from docs.generators.reference import part_sections, table
from harness.language.annotations import description_of, keys_of
from harness.robot.robot_yaml import RobotYaml

HEAD = """A folder with a `robot.yaml` is a robot that scenarios name by the folder's path:
`robot: {model: path/to/folder}`. `harness import srdf ARM.srdf --robot ARM.urdf -o FOLDER` writes
one from an arm's own files, with the gripper and the TCP that were found in them.

Numbers are SI and radians. Only keys marked as required must be given."""


def robot_yaml_page() -> str:
    """The page, a table for each model."""
    parts = ["# robot.yaml", HEAD, description_of(RobotYaml), table(keys_of(RobotYaml).items())]
    return "\n\n".join([*parts, *part_sections((RobotYaml,))]) + "\n"
