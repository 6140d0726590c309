"""A node that publishes statuses of goals as a server of an action does, and serves `/arm`.

It runs where rclpy is installed, without fretc. Each line of standard input is the statuses of all
goals, oldest first (`6 2`), or `call`, which calls the service; it is answered by `done`.
"""

from __future__ import annotations

import sys
import threading
from typing import Any

import rclpy  # type: ignore[import-not-found]
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray  # type: ignore[import-not-found]
from builtin_interfaces.msg import Time  # type: ignore[import-not-found]
from lifecycle_msgs.srv import GetState  # type: ignore[import-not-found]
from rclpy.executors import SingleThreadedExecutor  # type: ignore[import-not-found]
from rclpy.qos import (  # type: ignore[import-not-found]
    qos_profile_action_status_default,
    qos_profile_system_default,
)
from rclpy.service_introspection import (  # type: ignore[import-not-found]
    ServiceIntrospectionState,
)

TOPIC = "/navigate_to_pose/_action/status"


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("navigator")
    statuses = node.create_publisher(GoalStatusArray, TOPIC, qos_profile_action_status_default)

    def answer(request: Any, response: Any) -> Any:
        return response

    service = node.create_service(GetState, "/arm", answer)
    client = node.create_client(GetState, "/arm")
    how = node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.METADATA
    service.configure_introspection(*how)
    client.configure_introspection(*how)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    for line in sys.stdin:
        if line.strip() == "call":
            client.wait_for_service(20)
            client.call(GetState.Request(), 20)
        else:
            goals = [
                GoalStatus(goal_info=GoalInfo(stamp=Time(sec=i + 1)), status=int(word))
                for i, word in enumerate(line.split())
            ]
            statuses.publish(GoalStatusArray(status_list=goals))
        print("done", flush=True)


if __name__ == "__main__":
    main()
