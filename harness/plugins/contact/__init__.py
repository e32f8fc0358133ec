"""Work in contact: sensors of force and torque at the wrist, compliance, and insertions."""
