"""Forces of suction."""
