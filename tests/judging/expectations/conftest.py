"""Fixtures of these tests."""

from tests.approved import approved_texts as approved_texts
