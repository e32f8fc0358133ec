// A client of MoveIt in C++ on rcl, the layer beneath rclcpp: it sends what MoveGroupInterface sends
// to plan to joint positions, to execute the plan, to follow a line, to attach an object and to stop.
// It prints a line of JSON.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <geometry_msgs/msg/pose.h>
#include <moveit_msgs/action/execute_trajectory.h>
#include <moveit_msgs/action/move_group.h>
#include <moveit_msgs/msg/attached_collision_object.h>
#include <moveit_msgs/msg/constraints.h>
#include <moveit_msgs/msg/joint_constraint.h>
#include <moveit_msgs/msg/robot_trajectory.h>
#include <moveit_msgs/srv/get_cartesian_path.h>
#include <moveit_msgs/srv/query_planner_interfaces.h>
#include <rcl/error_handling.h>
#include <rcl/rcl.h>
#include <rcl_action/rcl_action.h>
#include <rosidl_runtime_c/string_functions.h>
#include <std_msgs/msg/string.h>

namespace {

void check(rcl_ret_t code, const char* what) {
  if (code != RCL_RET_OK) throw std::runtime_error(std::string(what) + ": " + rcl_get_error_string().str);
}

// Waits until something holds; only a hang reaches the end.
template <typename Holds>
void wait(Holds holds, const char* what) {
  for (int k = 0; k < 60000; ++k) {
    if (holds()) return;
    rcl_reset_error();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  throw std::runtime_error(std::string("no ") + what);
}

void set(rosidl_runtime_c__String& text, const char* value) {
  if (!rosidl_runtime_c__String__assign(&text, value)) throw std::bad_alloc();
}

uint8_t goals = 0;  // that were sent: each has an identifier of its own

struct Node {
  rcl_context_t context = rcl_get_zero_initialized_context();
  rcl_node_t node = rcl_get_zero_initialized_node();

  Node() {
    auto options = rcl_get_zero_initialized_init_options();
    check(rcl_init_options_init(&options, rcl_get_default_allocator()), "options");
    check(rcl_init(0, nullptr, &options, &context), "rcl");
    const auto node_options = rcl_node_get_default_options();
    check(rcl_node_init(&node, "move_group_interface", "", &context, &node_options), "node");
  }
};

// An action client of one type, whose names rosidl makes from the action's.
#define ACTION(NAME)                                                                              \
  struct NAME {                                                                                   \
    using Goal = moveit_msgs__action__##NAME##_SendGoal_Request;                                  \
    using Accepted = moveit_msgs__action__##NAME##_SendGoal_Response;                             \
    using Request = moveit_msgs__action__##NAME##_GetResult_Request;                                  \
    using Result = moveit_msgs__action__##NAME##_GetResult_Response;                              \
    static auto type() { return ROSIDL_GET_ACTION_TYPE_SUPPORT(moveit_msgs, NAME); }              \
    static Goal* goal() { return moveit_msgs__action__##NAME##_SendGoal_Request__create(); }      \
    static Result* result() { return moveit_msgs__action__##NAME##_GetResult_Response__create(); } \
  };
ACTION(MoveGroup)
ACTION(ExecuteTrajectory)

template <typename Kind>
struct Action {
  rcl_action_client_t client = rcl_action_get_zero_initialized_client();
  const rcl_node_t* node;

  Action(const rcl_node_t& owner, const char* name) : node(&owner) {
    const auto options = rcl_action_client_get_default_options();
    auto* mutable_node = const_cast<rcl_node_t*>(&owner);
    check(rcl_action_client_init(&client, mutable_node, Kind::type(), name, &options), name);
    bool is_ready = false;
    wait([&] { return rcl_action_server_is_available(node, &client, &is_ready) == RCL_RET_OK && is_ready; }, name);
  }

  // The result of a goal, which stays allocated until the program ends; `meanwhile` runs once it is accepted.
  template <typename Meanwhile>
  typename Kind::Result* run(typename Kind::Goal* goal, Meanwhile meanwhile) {
    goal->goal_id.uuid[0] = ++goals;
    int64_t number = 0;
    rmw_request_id_t header;
    check(rcl_action_send_goal_request(&client, goal, &number), "goal");
    typename Kind::Accepted accepted{};
    wait([&] { return rcl_action_take_goal_response(&client, &header, &accepted) == RCL_RET_OK; }, "response");
    if (!accepted.accepted) throw std::runtime_error("the goal is rejected");
    meanwhile();
    typename Kind::Request request{};
    request.goal_id = goal->goal_id;
    check(rcl_action_send_result_request(&client, &request, &number), "result");
    auto* result = Kind::result();
    wait([&] { return rcl_action_take_result_response(&client, &header, result) == RCL_RET_OK; }, "result");
    return result;
  }
};

template <typename Request, typename Response>
void call(const Node& owner, const rosidl_service_type_support_t* type, const char* name, Request* request,
          Response* response) {
  auto client = rcl_get_zero_initialized_client();
  const auto options = rcl_client_get_default_options();
  check(rcl_client_init(&client, &owner.node, type, name, &options), name);
  bool is_ready = false;
  wait([&] { return rcl_service_server_is_available(&owner.node, &client, &is_ready) == RCL_RET_OK && is_ready; }, name);
  int64_t number = 0;
  check(rcl_send_request(&client, request, &number), name);
  rmw_request_id_t header;
  wait([&] { return rcl_take_response(&client, &header, response) == RCL_RET_OK; }, name);
}

template <typename Message>
void publish(Node& owner, const rosidl_message_type_support_t* type, const char* name, Message* message) {
  static std::vector<rcl_publisher_t> kept;  // a reliable message is sent again while its writer lives
  kept.push_back(rcl_get_zero_initialized_publisher());
  const auto options = rcl_publisher_get_default_options();
  check(rcl_publisher_init(&kept.back(), &owner.node, type, name, &options), name);
  size_t count = 0;
  wait([&] { return rcl_publisher_get_subscription_count(&kept.back(), &count) == RCL_RET_OK && count; }, name);
  check(rcl_publish(&kept.back(), message, nullptr), name);
}

const char* const GROUP = "ur_manipulator";
const std::vector<std::pair<const char*, double>> JOINTS = {
    {"shoulder_pan_joint", 0.3}, {"shoulder_lift_joint", -1.2}, {"elbow_joint", 1.5},
    {"wrist_1_joint", -1.9},     {"wrist_2_joint", -1.57},      {"wrist_3_joint", 0.0}};

// The goal of MoveGroupInterface::plan: joint constraints with its tolerance, a scene that is a diff.
MoveGroup::Goal* joint_goal(double pan) {
  auto* sent = MoveGroup::goal();
  auto& request = sent->goal.request;
  set(request.group_name, GROUP);
  request.num_planning_attempts = 1;
  request.allowed_planning_time = 5.0;
  request.max_velocity_scaling_factor = request.max_acceleration_scaling_factor = 0.1;
  request.start_state.is_diff = true;
  moveit_msgs__msg__Constraints__Sequence__init(&request.goal_constraints, 1);
  auto& joints = request.goal_constraints.data[0].joint_constraints;
  moveit_msgs__msg__JointConstraint__Sequence__init(&joints, JOINTS.size());
  for (size_t k = 0; k < JOINTS.size(); ++k) {
    set(joints.data[k].joint_name, JOINTS[k].first);
    joints.data[k].position = k ? JOINTS[k].second : pan;
    joints.data[k].tolerance_above = joints.data[k].tolerance_below = 1e-4;
    joints.data[k].weight = 1.0;
  }
  auto& options = sent->goal.planning_options;
  options.plan_only = true;
  options.planning_scene_diff.is_diff = options.planning_scene_diff.robot_state.is_diff = true;
  return sent;
}

ExecuteTrajectory::Goal* execution(const moveit_msgs__msg__RobotTrajectory& trajectory) {
  auto* sent = ExecuteTrajectory::goal();
  moveit_msgs__msg__RobotTrajectory__copy(&trajectory, &sent->goal.trajectory);
  return sent;
}

void run() {
  Node owner;
  auto nothing = [] {};
  auto* planners = moveit_msgs__srv__QueryPlannerInterfaces_Response__create();
  auto* question = moveit_msgs__srv__QueryPlannerInterfaces_Request__create();
  call(owner, ROSIDL_GET_SRV_TYPE_SUPPORT(moveit_msgs, srv, QueryPlannerInterfaces), "query_planner_interface",
       question, planners);
  Action<MoveGroup> move(owner.node, "move_action");
  Action<ExecuteTrajectory> execute(owner.node, "execute_trajectory");

  auto* plan = move.run(joint_goal(0.3), nothing);
  const auto& trajectory = plan->result.planned_trajectory;
  auto* executed = execute.run(execution(trajectory), nothing);

  auto* line = moveit_msgs__srv__GetCartesianPath_Request__create();
  auto* path = moveit_msgs__srv__GetCartesianPath_Response__create();
  set(line->group_name, GROUP);
  line->start_state.is_diff = true;
  line->max_step = 0.01;
  line->avoid_collisions = true;
  line->max_velocity_scaling_factor = line->max_acceleration_scaling_factor = 0.1;
  geometry_msgs__msg__Pose__Sequence__init(&line->waypoints, 1);
  auto& pose = line->waypoints.data[0];
  pose.position.x = 0.4, pose.position.y = 0.2, pose.position.z = 0.4;
  pose.orientation.x = 1.0, pose.orientation.w = 0.0;
  call(owner, ROSIDL_GET_SRV_TYPE_SUPPORT(moveit_msgs, srv, GetCartesianPath), "compute_cartesian_path", line, path);

  auto* held = moveit_msgs__msg__AttachedCollisionObject__create();
  set(held->link_name, "end_effector_link");
  set(held->object.id, "cube");
  publish(owner, ROSIDL_GET_MSG_TYPE_SUPPORT(moveit_msgs, msg, AttachedCollisionObject), "attached_collision_object",
          held);

  auto* back = move.run(joint_goal(-0.8), nothing);
  auto* stopped = execute.run(execution(back->result.planned_trajectory), [&] {
    auto* stop = std_msgs__msg__String__create();
    set(stop->data, "stop");
    publish(owner, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, String), "trajectory_execution_event", stop);
  });
  std::printf("{\"planners\": %zu, \"plan\": [%d, %d], \"points\": %s, \"executed\": [%d, %d], "
              "\"line\": %d, \"stopped\": [%d, %d]}\n",
              planners->planner_interfaces.size, plan->status, plan->result.error_code.val,
              trajectory.joint_trajectory.points.size > 10 ? "true" : "false", executed->status,
              executed->result.error_code.val, path->error_code.val, stopped->status,
              stopped->result.error_code.val);
}

}  // namespace

int main() {
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
