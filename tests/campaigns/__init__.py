"""Long searches for inputs that end badly, started by hand; the tests have a sample of each."""
