"""The wire protocol of ROS 2 (DDSI-RTPS 2.3 over UDP), without a ROS installation."""
