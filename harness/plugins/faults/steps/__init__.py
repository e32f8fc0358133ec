"""Steps that inject faults."""
