# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Starts the estimator, and a bag and RViz beside it on request.

``ros2 launch reflest_ros estimator.launch.py camera:=realsense [namespace:=robot1] [rviz:=true]
[viewer:=true] [bag:=FOLDER] [config:=FILE]``; ``--show-args`` lists all arguments. Needs
launch_ros, which an apt installation of ROS 2 has; bag:= needs ros2bag, rviz:= needs rviz2 and
viewer:= the Python packages viser and trimesh as well, which rosdep.yaml has.
"""

from importlib.util import find_spec
from pathlib import Path

from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_package_share_directory,
)
from launch import Action, LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    ExecuteProcess,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
)
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node
from launch_ros.event_handlers import OnStateTransition

CONFIG = Path(get_package_share_directory("reflest_ros")) / "config"
CAMERAS = ("none", "realsense", "azure_kinect", "orbbec", "tum")
PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
RVIZ_TOPICS = (
    "/reflectance/voxels",
    "/reflectance/material_cloud",
    "/reflectance/material_markers",
    "/reflectance/overlay",
    "/reflectance/markers",
    "/reflectance/preview",
    "/reflectance/environment/preview",
    "/camera/color/image_raw",
    "/camera/pose",
)
"""Named in config/reflest.rviz; RViz resolves them in its namespace."""
ARGUMENTS = (
    ("camera", "none", "Camera whose topics, units and frames to expect.", CAMERAS),
    ("config", "", "Your own parameter file; its values win over the camera's.", None),
    ("namespace", "", "Namespace of the node and of every topic: one for each robot.", None),
    ("bag", "", "Bag to play (ros2 bag play) once the estimator listens.", None),
    ("rate", "1.0", "Speed at which the bag is played, times the recorded one.", None),
    ("rviz", "false", "Whether to open RViz on the topics.", ("true", "false")),
    ("viewer", "false", "Whether to serve the page in the browser.", ("true", "false")),
    ("viewer_host", "127.0.0.1", "Address of the page; 0.0.0.0 for the whole network.", None),
    ("use_sim_time", "false", "Whether time comes from /clock.", ("true", "false")),
    ("autostart", "true", "Whether the node configures and activates itself.", ("true", "false")),
    ("log_level", "info", "Of the node.", ("debug", "info", "warn", "error", "fatal")),
    ("tf", "/tf", "Topic of the transforms; a robot's own in a namespace: tf.", None),
    ("tf_static", "/tf_static", "Topic of the static transforms.", None),
)


VIEWER_PACKAGES = ("viser", "trimesh")


class LaunchError(RuntimeError):
    """Something that was asked for cannot be started; nothing is."""


def generate_launch_description() -> LaunchDescription:
    """Declare arguments, the shared-memory profile of Fast DDS, and the nodes.

    Returns:
        What ``ros2 launch`` runs.
    """
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(
                    name, default_value=default, description=description, choices=choices
                )
                for name, default, description, choices in ARGUMENTS
            ),
            SetEnvironmentVariable(
                PROFILES,
                EnvironmentVariable(
                    PROFILES, default_value=str(CONFIG / "fastdds_large_messages.xml")
                ),
            ),
            OpaqueFunction(function=nodes),
        ]
    )


def nodes(context: LaunchContext) -> list[Action]:
    """Make the nodes that the arguments ask for.

    Args:
        context: Holds the values of the arguments.

    Returns:
        The estimator, and the bag, the viewer and RViz where they are asked for.
    """
    given = {name: LaunchConfiguration(name).perform(context) for name, *_ in ARGUMENTS}
    uses_sim_time = given["use_sim_time"] == "true"
    if given["rviz"] == "true":
        _require("rviz2", "rviz:=true")
    if given["bag"]:
        _require("ros2bag", "bag:=")
    if given["viewer"] == "true":
        _require_python(*VIEWER_PACKAGES)
    estimator = LifecycleNode(
        package="reflest_ros",
        executable="estimator",
        name="reflest_estimator",
        namespace=given["namespace"],
        parameters=[
            *parameter_files(given["camera"], given["config"]),
            {
                "use_sim_time": uses_sim_time,
                "lifecycle.autostart": given["autostart"] == "true",
            },
        ],
        remappings=[("/tf", given["tf"]), ("/tf_static", given["tf_static"])],
        arguments=["--ros-args", "--log-level", f"reflest_estimator:={given['log_level']}"],
        output="screen",
    )
    wanted: list[Action] = [estimator]
    if given["bag"]:
        play = ["ros2", "bag", "play", given["bag"], "--rate", given["rate"]]
        if given["namespace"]:
            # It needs rclpy and the readers of bags: only where it is asked for.
            from reflest_ros.bag_player import namespace_remaps

            play += ["--remap", *namespace_remaps(Path(given["bag"]), given["namespace"])]
        player = ExecuteProcess(cmd=play + ["--clock"] * uses_sim_time, output="screen")
        # Not before the estimator listens, or it would miss the beginning.
        listening = OnStateTransition(
            target_lifecycle_node=estimator,
            goal_state="active",
            entities=[player],
            handle_once=True,
        )
        wanted.insert(0, RegisterEventHandler(listening))
    if given["viewer"] == "true":
        wanted.append(
            Node(
                package="reflest_ros",
                executable="viewer",
                namespace=given["namespace"],
                parameters=[{"host": given["viewer_host"]}],
                output="screen",
            )
        )
    if given["rviz"] == "true":
        wanted.append(
            Node(
                package="rviz2",
                executable="rviz2",
                namespace=given["namespace"],
                arguments=["-d", str(CONFIG / "reflest.rviz")],
                remappings=[(topic, topic.removeprefix("/")) for topic in RVIZ_TOPICS],
                parameters=[{"use_sim_time": uses_sim_time}],
            )
        )
    return wanted


def parameter_files(camera: str, config: str) -> list[str]:
    """List the parameter files; later ones win.

    Args:
        camera: Name of a camera, or none.
        config: The user's own file, or empty.

    Returns:
        Defaults, the camera's, the user's.
    """
    files = [str(CONFIG / "estimator.yaml")]
    if camera != "none":
        files.append(str(CONFIG / f"{camera}.yaml"))
    return [*files, config] if config else files


def _require(package: str, argument: str) -> None:
    """Raise :class:`LaunchError` before anything runs where a package is not installed."""
    try:
        get_package_prefix(package)
    except PackageNotFoundError:
        raise LaunchError(
            f"{argument} needs the package {package}, which is not installed: install "
            f"ros-$ROS_DISTRO-{package.replace('_', '-')} or leave the argument out"
        ) from None


def _require_python(*packages: str) -> None:
    """The same for what the viewer imports."""
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        raise LaunchError(
            f"viewer:=true needs the Python packages {' and '.join(missing)}: run rosdep install "
            "with reflest's rosdep.yaml, or pip install -r "
            "reflest_core/requirements-viewer.txt, or leave the argument out"
        )
