"""What many runs came to: results for machines, JUnit XML, GitHub's words, a page for people."""
