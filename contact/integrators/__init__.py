"""Methods for the motion with contacts."""
