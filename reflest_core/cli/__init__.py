"""The offline command line, `reflest`."""
