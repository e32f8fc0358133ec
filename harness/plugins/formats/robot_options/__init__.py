"""The options `kinematics` and `moveit`, which name files."""
