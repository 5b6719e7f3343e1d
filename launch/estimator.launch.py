"""``ros2 launch reflest_ros estimator.launch.py [config:=FILE] [namespace:=robot1]``.

Needs launch_ros, which an apt installation of ROS 2 brings.
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"


def generate_launch_description() -> LaunchDescription:
    """The estimator with a parameter file, in a namespace."""
    config = Path(get_package_share_directory("reflest_ros")) / "config"
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", default_value=str(config / "estimator.yaml")),
            DeclareLaunchArgument("namespace", default_value=""),
            SetEnvironmentVariable(
                PROFILES,
                EnvironmentVariable(
                    PROFILES, default_value=str(config / "fastdds_large_messages.xml")
                ),
            ),
            Node(
                package="reflest_ros",
                executable="estimator",
                namespace=LaunchConfiguration("namespace"),
                parameters=[LaunchConfiguration("config")],
                output="screen",
            ),
        ]
    )
