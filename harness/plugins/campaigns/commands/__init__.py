"""The commands of campaigns: results, search, bench, and merging the parts of a suite."""
