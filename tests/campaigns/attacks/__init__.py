"""Attacks on commands: odd paths, signals, limits, clocks, full disks, one folder, floods."""
