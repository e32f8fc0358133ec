"""Plug-ins for armharness."""
