# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The recording of ``recording.py`` written in the formats of data sets and phone scanners."""

import json

import cv2
import numpy as np

from reflest_core.capture.folders.icl_nuim import MIRROR
from reflest_core.capture.folders.nerfstudio import FROM_OPENGL
from reflest_core.capture.pose import quaternion_of
from test.core.capture.recording import (
    FOCAL,
    HEIGHT,
    WIDTH,
    K,
    camera_pose,
    colour_of,
    depth_of,
    write_seven_scenes,
    write_tum,
)

MATRIX = np.reshape(K, (3, 3))


def units(index, a_metre=1000.0):
    """Depth in whole units, of the recording's depth in whole millimetres."""
    return np.round(np.round(depth_of(index) * 1000) / 1000 * a_metre).astype(np.uint16)


def write_colour(path, index):
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), colour_of(index)[:, :, ::-1])


def write_depth(path, index, a_metre=1000.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), units(index, a_metre))


def write_three_r_scan(folder, count):
    folder.mkdir()
    four = np.eye(4)
    four[:3, :3] = MATRIX
    line = " ".join(map(str, four.ravel()))
    (folder / "_info.txt").write_text(
        f"m_versionNumber = 4\nm_calibrationColorIntrinsic = {line}\n"
        f"m_calibrationDepthIntrinsic = {line}\nm_depthShift = 1000\n"
    )
    for index in range(count):
        write_colour(folder / f"frame-{index:06d}.color.png", index)
        write_depth(folder / f"frame-{index:06d}.depth.pgm", index)
        np.savetxt(folder / f"frame-{index:06d}.pose.txt", camera_pose(index))


def write_scannet(folder, count):
    four = np.eye(4)
    four[:3, :3] = MATRIX
    for name in ("intrinsic", "pose"):
        (folder / name).mkdir(parents=True)
    for name in ("color", "depth"):
        np.savetxt(folder / f"intrinsic/intrinsic_{name}.txt", four)
    for index in range(count):
        write_colour(folder / f"color/{index}.png", index)
        write_depth(folder / f"depth/{index}.png", index)
        np.savetxt(folder / f"pose/{index}.txt", camera_pose(index))


def write_openloris(folder, count):
    lists = {"color.txt": [], "aligned_depth.txt": [], "groundtruth.txt": ["#Time, px, py, pz, qx"]}
    for index in range(count):
        stamp = f"{1560000000 + index / 30:.6f}"
        write_colour(folder / f"color/{stamp}.png", index)
        write_depth(folder / f"aligned_depth/{stamp}.png", index)
        lists["color.txt"].append(f"{stamp} color/{stamp}.png")
        lists["aligned_depth.txt"].append(f"{stamp} aligned_depth/{stamp}.png")
        pose = camera_pose(index)
        numbers = [*pose[:3, 3], *quaternion_of(pose[:3, :3])]
        lists["groundtruth.txt"].append(" ".join([stamp, *map(repr, map(float, numbers))]))
    for name, lines in lists.items():
        (folder / name).write_text("\n".join(lines))
    (folder / "sensors.yaml").write_text(openloris_sensors())


def openloris_sensors(order=("fx", "cx", "fy", "cy")):
    """OpenLORIS' calibration, as its publishers wrote it with OpenCV."""
    values = {"fx": MATRIX[0, 0], "fy": MATRIX[1, 1], "cx": MATRIX[0, 2], "cy": MATRIX[1, 2]}
    data = ", ".join(f"{values[name]:.16e}" for name in order)
    block = (
        "   sensor_type: camera\n   fps: 30\n   width: 848\n   height: 480\n   model: pinhole\n"
        "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
    )
    other = "      data: [ 9., 9.,\n          9., 9. ]\n"
    return (
        f"%YAML:1.0\nd400_depth_optical_frame:\n{block}{other}"
        f"d400_color_optical_frame:\n{block}      data: [ {data} ]\n"
        f"t265_fisheye1_optical_frame:\n{block}{other}"
    )


def write_icl_nuim(folder, count):
    lines = []
    for index in range(count):
        write_colour(folder / f"rgb/{index}.png", index)
        write_depth(folder / f"depth/{index}.png", index, 5000)
        pose = MIRROR @ camera_pose(index) @ MIRROR
        numbers = [index, *pose[:3, 3], *quaternion_of(pose[:3, :3])]
        lines.append(" ".join(map(repr, map(float, numbers))))
    (folder / "traj0.gt.freiburg").write_text("\n".join(lines))
    np.savetxt(folder / "camera-intrinsics.txt", MATRIX * [[1, 1, 1], [1, -1, 1], [1, 1, 1]])


def write_replica(folder, count):
    camera = {"w": WIDTH, "h": HEIGHT, "fx": FOCAL, "fy": FOCAL, "cx": WIDTH / 2, "cy": HEIGHT / 2}
    for index in range(count):
        write_colour(folder / f"results/frame{index:06d}.png", index)
        write_depth(folder / f"results/depth{index:06d}.png", index, 6553.5)
    np.savetxt(folder / "traj.txt", [camera_pose(index).ravel() for index in range(count)])
    (folder / "cam_params.json").write_text(json.dumps({"camera": {**camera, "scale": 6553.5}}))


def write_nerfstudio(folder, count):
    frames = []
    for index in range(count):
        write_colour(folder / f"images/{index:04d}.png", index)
        write_depth(folder / f"depth/{index:04d}.png", index)
        frames.append(
            {
                "file_path": f"images/{index:04d}.png",
                "depth_file_path": f"depth/{index:04d}.png",
                "transform_matrix": (camera_pose(index) @ FROM_OPENGL).tolist(),
            }
        )
    camera = {"fl_x": FOCAL, "fl_y": FOCAL, "cx": WIDTH / 2, "cy": HEIGHT / 2}
    document = {"camera_model": "OPENCV", "w": WIDTH, "h": HEIGHT, **camera, "frames": frames[::-1]}
    (folder / "transforms.json").write_text(json.dumps(document))


def write_record3d(folder, count):
    import OpenEXR

    poses = []
    for index in range(count):
        write_colour(folder / f"EXR_RGBD/rgb/{index}.png", index)
        (folder / "EXR_RGBD/depth").mkdir(exist_ok=True)
        metres = (units(index) * 0.001).astype(np.float32)
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(header, {"R": metres}) as file:
            file.write(str(folder / f"EXR_RGBD/depth/{index}.exr"))
        pose = camera_pose(index) @ FROM_OPENGL
        poses.append([*quaternion_of(pose[:3, :3]), *pose[:3, 3].tolist()])
    metadata = {"w": WIDTH, "h": HEIGHT, "K": MATRIX.T.ravel().tolist(), "poses": poses}
    (folder / "metadata.json").write_text(json.dumps(metadata))


def write_stray_scanner(folder, count):
    folder.mkdir()
    codec = cv2.VideoWriter.fourcc(*"mp4v")
    video = cv2.VideoWriter(str(folder / "rgb.mp4"), codec, 30, (WIDTH, HEIGHT))
    lines = ["timestamp, frame, x, y, z, qx, qy, qz, qw"]
    for index in range(count):
        video.write(np.ascontiguousarray(colour_of(index)[:, :, ::-1]))
        write_depth(folder / f"depth/{index:06d}.png", index)
        pose = camera_pose(index)
        numbers = [index / 30, index, *pose[:3, 3], *quaternion_of(pose[:3, :3])]
        lines.append(", ".join(map(repr, map(float, numbers))))
    video.release()
    (folder / "odometry.csv").write_text("\n".join(lines))
    np.savetxt(folder / "camera_matrix.csv", MATRIX, delimiter=",")


def write_apc(folder, count):
    folder.mkdir()
    blocks = ["# Color camera intrinsic matrix", MATRIX]
    for index in range(count):
        write_colour(folder / f"frame-{index:06d}.color.png", index)
        tenths = units(index, 10000)
        stored = (tenths << 3) | (tenths >> 13)
        cv2.imwrite(str(folder / f"frame-{index:06d}.depth.png"), stored)
        blocks += [f"# Camera-to-world extrinsic matrix (camera pose) for frame-{index:06d}"]
        blocks += [camera_pose(index)]
    with (folder / "cam.info.txt").open("w") as stream:
        for block in blocks:
            if isinstance(block, str):
                stream.write(f"\n{block}\n")
            else:
                np.savetxt(stream, block, fmt="%.17g")


WRITERS = {
    "seven_scenes": write_seven_scenes,
    "tum": write_tum,
    "three_r_scan": write_three_r_scan,
    "scannet": write_scannet,
    "openloris": write_openloris,
    "icl_nuim": write_icl_nuim,
    "replica": write_replica,
    "nerfstudio": write_nerfstudio,
    "record3d": write_record3d,
    "stray_scanner": write_stray_scanner,
    "apc": write_apc,
}
LOSSY = ("stray_scanner",)
"""Formats whose colours are a video's."""
