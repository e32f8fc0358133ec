"""What explains a failed planning call."""
