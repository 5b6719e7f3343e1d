"""What real captures have and renders lack: drift, noise, compression, holes, jitter."""
