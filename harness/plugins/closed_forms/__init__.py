"""Inverse kinematics of arms that have a closed form: Universal Robots, and OpenMANIPULATOR-X."""
