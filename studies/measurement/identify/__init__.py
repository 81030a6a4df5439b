"""From a measured record to the parameters and their errors."""
