"""Inverse kinematics: closed forms, a numeric solver, nearest reachable poses."""
