"""What is measured on a finished run: clearances, contacts, tracking of the plan, findings."""
