"""What "U shaped" can mean: the springs, their tables, checks against solids, figures."""
