"""Results of many runs as a database: queries, comparisons of two campaigns, and exports."""
