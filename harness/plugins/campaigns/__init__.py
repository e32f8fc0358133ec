"""Campaigns: suites of many runs, on several machines, searched, compared and queried."""

EXTRAS = {"cmaes": "search", "scipy": "search", "pyarrow": "parquet", "ray": "cluster"}
"""Packages that it needs for searches, Parquet files and clusters, and the extra that has each."""
