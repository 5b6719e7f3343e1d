"""``make demo``: a shipped capture through the real node, compared with its truth."""
