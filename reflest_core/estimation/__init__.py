"""Store in, estimate out; and the scanner that node and replay share."""
