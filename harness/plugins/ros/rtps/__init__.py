"""The wire protocol of ROS 2 (DDSI-RTPS 2.3 over UDP), without a ROS installation.

No package does this (2026). A service answers rclpy on Fast DDS by a parameter next to the sample
(PID_RELATED_SAMPLE_IDENTITY), which cyclonedds 11, dust-dds 0.16 and zerodds 1.0 cannot write.
espp 1.3 and roswell 0.1 write it, but espp answers every request at once, keeps nothing for nodes
that come later, and has no list of other nodes; roswell writes no lists of strings or
messages, rejects no goal, and uses every interface. rosless 0.5 has topics alone, pi-fastdds 0.1 a
protocol of its own.
"""
