"""Campaigns: suites of many runs, on several machines, searched, compared and queried."""

EXTRAS = {"pyarrow": "parquet", "ray": "cluster"}
"""Packages that it needs for Parquet files and for clusters, and the extra that has each."""
