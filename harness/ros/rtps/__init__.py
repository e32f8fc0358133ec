"""The wire protocol of ROS 2 (DDSI-RTPS 2.3 over UDP), without a ROS installation.

No package does this (2026). A service answers rclpy on Fast DDS by a parameter next to the sample
(PID_RELATED_SAMPLE_IDENTITY), which cyclonedds 11 and dust-dds 0.16 cannot write. roswell 0.1
writes it, but no lists of strings or messages; it rejects no goal and uses every interface. rosless
0.5 has topics alone, and pi-fastdds 0.1 a protocol of its own.
"""
