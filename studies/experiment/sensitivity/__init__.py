"""The six transitions under errors, noise and open assumptions."""
