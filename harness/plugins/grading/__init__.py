"""Points for a recorded bag or run that another program produced."""
