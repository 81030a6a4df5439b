"""What the spring settles on, and which starts lead where."""
