"""Visual odometry."""
