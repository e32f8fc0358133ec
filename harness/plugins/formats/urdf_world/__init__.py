"""Objects with joints in URDF: cabinets, doors, drawers."""
