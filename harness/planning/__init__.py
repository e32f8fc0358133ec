"""Planner, planning scene and kinematics on OMPL, Pinocchio, Coal and TOPP-RA."""
