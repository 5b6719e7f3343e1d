"""One module for each measurement, with a function ``measure`` that returns what fits into JSON."""
