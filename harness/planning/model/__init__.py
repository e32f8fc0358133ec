"""The robot in Pinocchio, forward kinematics and turns of revolute joints."""
