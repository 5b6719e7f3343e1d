# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Starts the estimator, and what is asked for beside it.

``ros2 launch reflest_ros estimator.launch.py camera:=realsense [namespace:=robot1] [rviz:=true]
[bag:=FOLDER] [config:=FILE]``. Needs launch_ros, which an apt installation of ROS 2 brings; bag:=
needs ros2bag and rviz:= needs rviz2 as well.
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
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
    "/reflectance/markers",
    "/reflectance/preview",
    "/reflectance/environment/preview",
    "/camera/color/image_raw",
    "/camera/pose",
)
"""Named in config/reflest.rviz; RViz looks for them in its namespace."""
ARGUMENTS = (
    ("camera", "none", "Camera whose topics, units and frames to expect.", CAMERAS),
    ("config", "", "Your own parameter file; its values win over the camera's.", None),
    ("namespace", "", "Namespace of the node and of every topic: one for each robot.", None),
    ("bag", "", "Bag to play (ros2 bag play) once the estimator listens.", None),
    ("rate", "1.0", "Speed at which the bag is played, times the recorded one.", None),
    ("rviz", "false", "Whether to open RViz on the topics.", ("true", "false")),
    ("use_sim_time", "false", "Whether time comes from /clock.", ("true", "false")),
)


def generate_launch_description() -> LaunchDescription:
    """The arguments, the shared-memory profile of Fast DDS, and the nodes."""
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
    """The estimator, and the bag and RViz where they are asked for."""
    given = {name: LaunchConfiguration(name).perform(context) for name, *_ in ARGUMENTS}
    uses_sim_time = given["use_sim_time"] == "true"
    estimator = LifecycleNode(
        package="reflest_ros",
        executable="estimator",
        name="reflest_estimator",
        namespace=given["namespace"],
        parameters=[
            *parameter_files(given["camera"], given["config"]),
            {"use_sim_time": uses_sim_time},
        ],
        output="screen",
    )
    wanted: list[Action] = [estimator]
    if given["bag"]:
        play = ["ros2", "bag", "play", given["bag"], "--rate", given["rate"]]
        player = ExecuteProcess(cmd=play + ["--clock"] * uses_sim_time, output="screen")
        # Not before the estimator listens, or it would miss the beginning.
        listening = OnStateTransition(
            target_lifecycle_node=estimator,
            goal_state="active",
            entities=[player],
            handle_once=True,
        )
        wanted.insert(0, RegisterEventHandler(listening))
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
    """Defaults first, then the camera's, then the user's."""
    files = [str(CONFIG / "estimator.yaml")]
    if camera != "none":
        files.append(str(CONFIG / f"{camera}.yaml"))
    return [*files, config] if config else files
