"""The report of one run: a page in one file that opens from disk, with nothing fetched."""
