"""MoveIt's interface, served for the arm of a scenario: requests, planning scene, answers."""
