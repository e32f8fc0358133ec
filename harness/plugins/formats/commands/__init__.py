"""The command of other programs' formats."""
