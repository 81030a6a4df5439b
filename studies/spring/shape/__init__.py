"""What "U shaped" can mean: springs of one period; the flat U as a plate."""
