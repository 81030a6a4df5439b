"""What "U shaped" can mean: four springs of one period, and strip theory against solids."""
