# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reads a folder's text files, images and depth maps, and makes messages of them."""

from __future__ import annotations

import errno
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.array_file import read_array
from reflest_core.capture.formats.bag_file import pointer_sentence
from reflest_core.capture.images.compressed_header import MOST_PIXELS, read_header
from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    CompressedImageMessage,
    ImageMessage,
    PoseMessage,
)
from reflest_core.capture.pose import quaternion_of
from reflest_core.capture.refusal import CaptureError

Pinhole = tuple[float, float, float, float]
INTRINSICS = ("camera-intrinsics.txt", "camera-intrinsics.color.txt")
PACKED = (".png", ".jpg", ".jpeg")
FRAME_RATE = 30
"""Of formats that have no time, frames a second."""
MOST_SECONDS = 2**63 / 1e9
UNREADABLE = (ValueError, KeyError, TypeError, AttributeError, ArithmeticError, RecursionError)
"""What a damaged text file makes its parsing raise."""


def read_text(path: Path) -> str:
    """Return a text file's content, without a byte order mark.

    Args:
        path: The file.

    Raises:
        CaptureError: It cannot be read as text.
    """
    try:
        return _read_bytes(path).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise CaptureError(f"{path} cannot be read: {error}") from error


def read_matrix(path: Path, *shapes: tuple[int, int]) -> NDArray[np.float64] | None:
    """Return the matrix in a text file, numbers parted by blanks or commas.

    Args:
        path: The file.
        shapes: Rows and columns that it may have.

    Returns:
        The matrix, or None where the file holds no matrix of such a shape.
    """
    rows = [re.split(r"[,\s]+", line.strip()) for line in read_text(path).splitlines()]
    try:
        values = [[float(word) for word in row if word] for row in rows if any(row)]
        matrix = np.array(values, np.float64)
    except ValueError:
        return None
    return matrix if matrix.shape in shapes else None


def pose_in(path: Path) -> NDArray[np.float64] | None:
    """Return the 4 x 4 matrix in a file.

    Args:
        path: The file.

    Returns:
        The matrix; NaN where the file holds none, so that it is refused; None without a file.
    """
    if not path.is_file():
        return None
    matrix = read_matrix(path, (4, 4))
    return np.full((4, 4), np.nan) if matrix is None else matrix


def pose_message(matrix: NDArray[np.float64], stamp_ns: int) -> PoseMessage:
    """Return a pose message.

    Args:
        matrix: (4, 4) ``T_world_camera`` of the optical frame.
        stamp_ns: Its stamp.
    """
    x, y, z = matrix[:3, 3].tolist()
    return PoseMessage(stamp_ns, "", (x, y, z), quaternion_of(matrix[:3, :3]))


def colour_message(path: Path, stamp_ns: int) -> AnyImage:
    """Return a colour image; png and jpeg are not unpacked.

    Args:
        path: The file, of any format that OpenCV reads.
        stamp_ns: Its stamp.

    Raises:
        OSError: The file cannot be read.
    """
    data = _read_bytes(path)
    if path.suffix.lower() in PACKED:
        return CompressedImageMessage(stamp_ns, "", path.suffix, data)
    pixels = _unpacked(data, cv2.IMREAD_COLOR)
    if pixels is None:
        return CompressedImageMessage(stamp_ns, "", path.suffix, data)
    return image_message(np.asarray(pixels, np.uint8), "bgr8", stamp_ns)


def depth_message(path: Path, stamp_ns: int) -> AnyImage:
    """Return a depth map: png, 16-bit pgm or tiff, float tiff, npy or exr.

    Args:
        path: The file; integers are in the format's unit, floats in metres.
        stamp_ns: Its stamp.

    Raises:
        OSError: The file cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix == ".npy":
        return _depth_pixels(_read_npy(path), stamp_ns)
    if suffix == ".exr":
        return _depth_pixels(_read_exr(path), stamp_ns)
    data = _read_bytes(path)
    if suffix == ".png":
        return CompressedImageMessage(stamp_ns, "", "16UC1; png", data)
    pixels = _unpacked(data, cv2.IMREAD_UNCHANGED)
    return _depth_pixels(np.empty((0, 0)) if pixels is None else pixels, stamp_ns)


def image_message(pixels: NDArray[np.generic], encoding: str, stamp_ns: int) -> ImageMessage:
    """Return a raw image message.

    Args:
        pixels: (H, W) or (H, W, C).
        encoding: What the message calls them.
        stamp_ns: Its stamp.
    """
    pixels = np.ascontiguousarray(pixels)
    height, width = pixels.shape[:2]
    step = pixels.nbytes // max(height, 1)
    return ImageMessage(stamp_ns, "", height, width, encoding, False, step, pixels.tobytes())


def image_size(path: Path) -> tuple[int, int]:
    """Return width and height of an image.

    Args:
        path: Any image or depth map that is read here.

    Raises:
        CaptureError: It is none.
    """
    data = _read_bytes(path)
    header = read_header(data)
    if header is not None:
        return header.width, header.height
    if path.suffix.lower() in (".npy", ".exr"):
        message = depth_message(path, 0)
        assert isinstance(message, ImageMessage)
        return message.width, message.height
    pixels = _unpacked(data, cv2.IMREAD_UNCHANGED)
    if pixels is None:
        raise CaptureError(pointer_sentence(path) or f"{path} is neither a jpeg nor a png")
    return int(pixels.shape[1]), int(pixels.shape[0])


def folder_pinhole(
    folder: Path, names: Sequence[str] = INTRINSICS, usual: Pinhole | None = None
) -> Pinhole:
    """Return fx, fy, cx, cy from the 3 x 3 (or 4 x 4) matrix beside the frames.

    Args:
        folder: It, or its parent, holds the file.
        names: Names that the file may have.
        usual: What stands for a file that is not there; None: it is needed.

    Raises:
        CaptureError: There is no such file and it is needed, or it holds something else.
    """
    for place in (folder, folder.absolute().parent):
        for path in (place / name for name in names):
            if not path.is_file():
                continue
            matrix = read_matrix(path, (3, 3), (4, 4))
            if matrix is None:
                raise CaptureError(f"{path} does not hold a 3 x 3 camera matrix")
            return pinhole_of(matrix)
    if usual is not None:
        return usual
    raise CaptureError(
        f"{folder} has no {names[0]} (3 x 3 matrix): add it or give --intrinsics FX FY CX CY"
    )


def pinhole_of(matrix: NDArray[np.float64]) -> Pinhole:
    """Return fx, fy, cx, cy of a camera matrix.

    Args:
        matrix: (3, 3) or larger, pixels.
    """
    return float(matrix[0, 0]), float(matrix[1, 1]), float(matrix[0, 2]), float(matrix[1, 2])


def camera_info(
    pinhole: Pinhole,
    size: tuple[int, int],
    distortion: tuple[float, ...] = (),
    model: str = "plumb_bob",
) -> CameraInfoMessage:
    """Return a calibration that is in force for good.

    Args:
        pinhole: fx, fy, cx, cy in pixels.
        size: Width and height of the images.
        distortion: Coefficients of ``model``.
        model: As ``CameraInfo.distortion_model``.
    """
    fx, fy, cx, cy = pinhole
    matrix = (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
    return CameraInfoMessage(0, "", *size, matrix, distortion, model)


def resized(info: CameraInfoMessage, size: tuple[int, int]) -> CameraInfoMessage:
    """Return the calibration of the same view in another size; pixel centres are at integers.

    Args:
        info: Of the original images.
        size: Width and height of the others.
    """
    across, down = size[0] / info.width, size[1] / info.height
    fx, fy, cx, cy = info.k[0], info.k[4], info.k[2], info.k[5]
    pinhole = (fx * across, fy * down, (cx + 0.5) * across - 0.5, (cy + 0.5) * down - 0.5)
    return camera_info(pinhole, size, info.d, info.distortion_model)


def stamp_of(seconds: float) -> int:
    """Return a stamp in nanoseconds.

    Args:
        seconds: Time as a file gives it.

    Raises:
        ValueError: It is no time that fits a message.
    """
    if not abs(seconds) < MOST_SECONDS:
        raise ValueError(f"{seconds} s is no time")
    return round(seconds * 1e9)


def by_number(folder: Path, pattern: str) -> dict[int, Path]:
    """Return a folder's files by the number in their names, in its order.

    Args:
        folder: It may be missing; then there are none.
        pattern: Matches the whole name, the number as its first group.
    """
    if not folder.is_dir():
        return {}
    matches = (
        (re.fullmatch(pattern, path.name, re.IGNORECASE), path) for path in sorted(folder.iterdir())
    )
    found = {int(match[1]): path for match, path in matches if match}
    return dict(sorted(found.items()))


ReadImage = Callable[[], AnyImage]


def _check_file(path: Path) -> None:
    """Raise an OSError for what is missing, and for pipes and devices, whose reading never ends."""
    if not path.is_file():
        raise FileNotFoundError(errno.ENOENT, "it is no regular file", str(path))


def _read_bytes(path: Path) -> bytes:
    _check_file(path)
    return path.read_bytes()


def _unpacked(data: bytes, flags: int) -> NDArray[np.generic] | None:
    """Return an image's pixels, None where it is damaged, too large or not for OpenCV."""
    header = read_header(data)
    if header and not (header.is_complete and header.width * header.height <= MOST_PIXELS):
        return None
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), flags) if data else None
    except cv2.error:
        return None
    return None if pixels is None else np.asarray(pixels)


def _depth_pixels(pixels: NDArray[np.generic], stamp_ns: int) -> ImageMessage:
    pixels = np.squeeze(pixels)
    if pixels.ndim == 2 and pixels.dtype.kind == "f":
        return image_message(pixels.astype("<f4"), "32FC1", stamp_ns)
    if pixels.ndim == 2 and pixels.dtype == np.uint16:
        return image_message(pixels.astype("<u2"), "16UC1", stamp_ns)
    return image_message(np.zeros((1, 1), np.uint8), f"{pixels.dtype} {pixels.shape}", stamp_ns)


def _read_npy(path: Path) -> NDArray[np.generic]:
    _check_file(path)
    try:
        return read_array(path)
    except ValueError:
        return np.empty((0, 0))


def _read_exr(path: Path) -> NDArray[np.generic]:
    import OpenEXR

    _check_file(path)
    try:
        with OpenEXR.File(str(path)) as file:
            channels = file.channels()
            name = next((name for name in ("Z", "R", "Y", "RGB", "RGBA") if name in channels), None)
            pixels = np.asarray(channels[name or next(iter(channels))].pixels)
    except (RuntimeError, StopIteration):
        return np.empty((0, 0))
    return pixels if pixels.ndim == 2 else pixels[..., 0]
