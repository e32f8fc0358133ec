"""Many scenarios, each in a process of its own."""
