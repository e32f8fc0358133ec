"""The options `mount` and `robots`."""
