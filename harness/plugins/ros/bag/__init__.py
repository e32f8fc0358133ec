"""A run as a rosbag2 that other tools open: RViz, Foxglove, rerun, PlotJuggler."""
