# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is read of a compressed image without unpacking it, wherever it was cut off."""

import cv2
import numpy as np
import pytest

from reflest_core.capture.images.compressed_header import read_header

HEIGHT, WIDTH = 30, 40


@pytest.mark.parametrize(("suffix", "kind"), [(".jpg", "jpeg"), (".png", "png")])
def test_a_cut_off_image_is_known_by_its_size_or_not_at_all(suffix, kind):
    image = np.arange(HEIGHT * WIDTH * 3, dtype=np.uint32).astype(np.uint8)
    _, encoded = cv2.imencode(suffix, image.reshape(HEIGHT, WIDTH, 3))
    data = encoded.tobytes()
    headers = [read_header(data[:length]) for length in range(len(data) + 1)]
    whole = headers[-1]
    assert (whole.kind, whole.width, whole.height) == (kind, WIDTH, HEIGHT)
    assert (whole.bit_depth, whole.channels, whole.is_complete) == (8, 3, True)
    first = next(length for length, header in enumerate(headers) if header is not None)
    for header in headers[first:]:
        assert (header.width, header.height, header.channels) == (WIDTH, HEIGHT, 3)
    assert not headers[first].is_complete
    assert all(header is None for header in headers[:first])
