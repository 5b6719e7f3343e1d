"""What the constants of realism are measured with: real fusion, a real codec."""
