"""The experiment of the letter: its figures, its claims, and what lies behind them."""
