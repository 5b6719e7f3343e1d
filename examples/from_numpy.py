# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimate a material from arrays: colour, depth, calibration and pose, whatever they come from.

    python examples/from_numpy.py

The frames are of a ball under a bright sky, drawn here so that the example needs no file.
"""

import numpy as np

from reflest_core import Scanner, sphere

WIDTH, HEIGHT, FOCUS = 160, 120, 150.0
RADIUS = 0.1
ALBEDO = np.array([0.5, 0.12, 0.05])
K = np.array([[FOCUS, 0.0, (WIDTH - 1) / 2], [0.0, FOCUS, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]])


def look_at_origin(position: np.ndarray) -> np.ndarray:
    """Pose (4, 4) of a camera that looks at the origin: z forward, x right, y down."""
    forward = -position / np.linalg.norm(position)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = position
    return pose


def sky(directions: np.ndarray) -> np.ndarray:
    """Linear radiance from a direction: brighter and bluer above."""
    height = directions[..., 2:]
    return 0.25 + (0.2 + 0.2 * height) * np.array([0.9, 1.0, 1.2])


def view(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Colour (H, W, 3) uint8 and depth (H, W) in metres of the ball before the sky."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(K).T
    directions = rays @ pose[:3, :3].T
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    centre = pose[:3, 3]
    along = -directions @ centre
    under_root = along**2 - (centre @ centre - RADIUS**2)
    is_ball = under_root > 0.0
    distance = along - np.sqrt(np.maximum(under_root, 0.0))
    normals = (centre + distance[..., None] * directions) / RADIUS
    # A matt ball reflects the cosine-weighted mean of the sky, which is linear in the height here.
    irradiance = 0.25 + (0.2 + 0.2 * normals[..., 2:] * 2 / 3) * np.array([0.9, 1.0, 1.2])
    linear = np.where(is_ball[..., None], ALBEDO * irradiance, sky(directions))
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    depth = np.where(is_ball, distance / np.linalg.norm(rays, axis=-1), 0.0)
    return np.rint(255.0 * np.clip(encoded, 0.0, 1.0)).astype(np.uint8), depth


def main() -> None:
    """Scan the ball from two heights and print its albedo."""
    scanner = Scanner(region=sphere((0.0, 0.0, 0.0), 1.5 * RADIUS))
    for number in range(40):
        turn, height = 2.0 * np.pi * number / 20, 0.15 if number < 20 else 0.35
        pose = look_at_origin(np.array([0.4 * np.cos(turn), 0.4 * np.sin(turn), height]))
        rgb, depth = view(pose)
        scanner.add(rgb, depth, K, pose, stamp=number / 10)
    estimate = scanner.estimate()
    print("true albedo     ", *ALBEDO)
    print("estimated albedo", *(f"{value:.2f}" for value in estimate.rho_d))
    print("deviation       ", *(f"{value:.2f}" for value in estimate.rho_d_stddev))


if __name__ == "__main__":
    main()
