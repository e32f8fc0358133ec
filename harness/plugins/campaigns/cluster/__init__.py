"""Cases of a suite on a cluster: batches of them, and what runs a batch on a node."""
